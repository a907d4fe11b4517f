#include "solver/error/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/random.h"
#include "solver/error/error_propagation.h"
#include "solver/error/quantiles.h"
#include "solver/error/reflected_errors.h"

namespace patchlight {

namespace {

constexpr std::size_t kDraws = 20;       // bootstrap draws where errors propagate between patches
constexpr double kMaxPropagated = 0.05;  // relative change of an error by propagation that one draw is enough for
constexpr std::size_t kFewDraws = 5;     // that are enough where they hardly differ
constexpr double kSmallVariance = 0.01;  // relative, of the draws' squares, up to which they hardly differ
constexpr double kMaxUnsolved = 0.02;    // error by the residual that need not be solved for, over that by sampling
constexpr double kMaxMissing = 3;        // power by the energy balance, in standard deviations of the power
constexpr double kLocalLevel = 0.95;     // part of the area whose local errors the stated one bounds

Spectrum root(const Spectrum& s) {
  Spectrum result;
  for (int k = 0; k < 3; ++k) result.c[k] = std::sqrt(s.c[k]);
  return result;
}

/// A sum of squared deviations, and the variance of that: each varies as the square of a normal variate.
struct SquareSum {
  double sum = 0.0, variance = 0.0;

  /// `correlated`: number of deviations that vary together.
  void add(double square, double correlated) {
    sum += square;
    variance += 2 * square * square * correlated;
  }
  double relative_variance() const { return sum > 0 ? variance / (sum * sum) : 0.0; }
};

class Estimator {
 public:
  Estimator(const PatchSet& scene, const FormFactorRows& rows, const Scattering& scattering,
            const std::vector<double>& areas, const SampledSolution& solution, const EnergyBalance& balance)
      : reflectance_(scattering.albedo),
        areas_(areas),
        solution_(solution),
        balance_(balance),
        propagation_(rows, scattering, areas),
        errors_(scene, scattering.albedo, areas, solution.irradiance) {}

  EnergyField::Estimate operator()() {
    EnergyField::Estimate estimate;
    sum_deviations(estimate);
    norm_ = errors_.squared_norm(solution_.irradiance);
    if (norm_ == 0) {
      estimate.error_local = 0;
      return estimate;
    }
    by_residual_ = propagation_.propagate_safely(solution_.residual, kMaxUnsolved * deviation_norm_);
    make_draws();
    set_global(estimate);
    set_local(estimate);
    return estimate;
  }

 private:
  /// Deviations with random signs.
  struct RandomError {
    SpectrumField sampled;   ///< [n] As the linear system has it.
    SpectrumField filtered;  ///< [n] As the solution has it.
  };

  /// Squares of a random error.
  struct Draw {
    double ratio = 1.0;        ///< Squared norm with the propagation to other patches, over that without.
    double local = 0.0;        ///< Squared percentile of local errors, of all causes but the balance.
    double local_above = 0.0;  ///< The same at above_local_level_.
  };

  /// Sums over the patches; sets the estimate's deviations.
  void sum_deviations(EnergyField::Estimate& estimate) {
    std::vector<SpectrumField> filtered;
    for (const auto& part : solution_.filtered) {
      filtered.push_back(part.filter->apply(*part.deviation));
      errors_.add_bias(*part.filter);
    }
    SpectrumField deviations;
    double area = 0, squared_area = 0;
    for (std::size_t i = 0; i < areas_.size(); ++i) {
      Spectrum square = solution_.deviation[i] * solution_.deviation[i];
      for (const SpectrumField& field : filtered) square += field[i] * field[i];
      const Spectrum deviation = deviations.emplace_back(root(square)) * reflectance_[i];
      estimate.deviation.emplace_back(float(deviation.c[0]), float(deviation.c[1]), float(deviation.c[2]));
      if (!errors_.is_counted(i)) continue;
      const double a = areas_[i], s = errors_.square_at(i, deviations[i]);
      double correlated = 1;
      for (const auto& part : solution_.filtered) {
        bias_ += a * part.filter->bias(i).square;
        bias_variance_ += a * a * part.filter->bias(i).variance;
        correlated = std::max(correlated, part.filter->correlated_patches(i));
      }
      own_.add(a * s, correlated);
      total_.add(a * a * s, correlated);
      if (reflectance_[i].sum() == 0) continue;
      area += a;
      squared_area += a * a * correlated;
    }
    deviation_norm_ = propagation_.norm(deviations);
    if (area == 0) return;
    const double patches = area * area / squared_area;  // that vary independently
    above_local_level_ += kNormalQuantile95 * std::sqrt(kLocalLevel * (1 - kLocalLevel) / patches);
    above_local_level_ = std::min(above_local_level_, 1.0);
  }

  RandomError random_error(std::uint64_t index) const {
    const auto with_random_signs = [&](const SpectrumField& deviation, std::uint64_t bit) {
      SpectrumField drawn;
      drawn.reserve(areas_.size());
      for (std::size_t i = 0; i < areas_.size(); ++i)
        drawn.push_back(deviation[i] * Spectrum(hash64(hash64(index) + i) >> bit & 1 ? -1.0 : 1.0));
      return drawn;
    };
    RandomError error{with_random_signs(solution_.deviation, 0), {}};
    error.filtered = error.sampled;
    // Filtered deviations are correlated between patches: filter the signed ones alike.
    for (std::size_t p = 0; p < solution_.filtered.size(); ++p) {
      const auto& part = solution_.filtered[p];
      const SpectrumField drawn = with_random_signs(*part.deviation, p + 1);
      add(drawn, error.sampled);
      add(part.filter->apply(drawn), error.filtered);
    }
    return error;
  }

  /// The light that patches most likely miss, given how much they miss in all, W/m2: as their squared deviations.
  SpectrumField missing_light() const {
    const Spectrum power = balance_.missing_power(by_residual_);
    SpectrumField missing;
    Spectrum total;
    for (std::size_t i = 0; i < areas_.size(); ++i) {
      Spectrum square = solution_.deviation[i] * solution_.deviation[i];
      for (const auto& part : solution_.filtered) square += (*part.deviation)[i] * (*part.deviation)[i];
      missing.push_back(square * Spectrum(areas_[i]));
      total += missing.back() * Spectrum(areas_[i]);
    }
    Spectrum factor;  // no more than the deviations explain: the balance of an open scene errs by itself
    for (int k = 0; k < 3; ++k)
      if (const double likely = kMaxMissing * std::sqrt(total.c[k]); likely > 0)
        factor.c[k] = std::clamp(power.c[k], -likely, likely) / total.c[k];
    for (Spectrum& m : missing) m *= factor;
    return missing;
  }

  /// Adds draws: one, or kFewDraws to kDraws where errors propagate. Finds the error by the energy balance.
  void make_draws() {
    by_balance_ = missing_light();
    add(propagation_.propagate(by_balance_), by_balance_);
    RandomError error = random_error(0);
    own_local_ = error.filtered;
    add(by_residual_, own_local_);
    const double local_without = errors_.percentile(own_local_, kLocalLevel);
    add(by_balance_, own_local_);
    add_draw(std::move(error));
    const double local_change = std::abs(std::sqrt(draws_[0].local) - local_without);
    if (std::abs(std::sqrt(draws_[0].ratio) - 1) <= kMaxPropagated && local_change <= kMaxPropagated * local_without)
      return;
    while (draws_.size() < kDraws && (draws_.size() < kFewDraws || differ())) add_draw(random_error(draws_.size()));
  }

  bool differ() const {
    return std::max(spread(&Draw::ratio).relative_variance, spread(&Draw::local).relative_variance) > kSmallVariance;
  }

  void add_draw(RandomError drawn) {
    Draw& draw = draws_.emplace_back();
    SpectrumField& error = drawn.filtered;
    const double before = errors_.squared_norm(error);
    add(propagation_.propagate(drawn.sampled), error);
    if (before > 0) draw.ratio = errors_.squared_norm(error) / before;
    add(by_residual_, error);
    draw.local = std::pow(errors_.percentile(error, kLocalLevel), 2);
    draw.local_above = std::pow(errors_.percentile(error, above_local_level_), 2);
  }

  Spread spread(double Draw::*member) const {
    std::vector<double> values;
    for (const Draw& draw : draws_) values.push_back(draw.*member);
    return Spread(values);
  }

  /// Relative variance of a mean over the draws, as an estimate.
  double variance_of_mean(const Spread& drawn) const {
    if (draws_.size() == 1) return own_.relative_variance();
    return std::max(own_.relative_variance(), total_.relative_variance()) +
           drawn.relative_variance / double(draws_.size());
  }

  void set_global(EnergyField::Estimate& estimate) const {
    const Spread ratio = spread(&Draw::ratio);
    const double own = own_.sum, drawn = own * std::max(ratio.mean, 1.0);
    const double residual = std::sqrt(errors_.squared_norm(by_residual_)),
                 balance = std::sqrt(errors_.squared_norm(by_balance_));
    const double square = std::max(drawn, own + balance * balance);
    double bound = 0;
    if (own > 0) {
      const double variance = own_.variance / (drawn * drawn) + ratio.relative_variance;
      const double own_bound = own * upper_ratio_95(own_.relative_variance(), own_.relative_variance());
      bound = std::max(drawn * upper_ratio_95(variance, variance_of_mean(ratio)),
                       std::pow(std::sqrt(own_bound) + balance, 2));
    }
    const double above = std::max(bound - square, 0.0), bias = std::max(bias_, 0.0);
    const double uncertain = std::sqrt(above * above + kNormalQuantile95 * kNormalQuantile95 * bias_variance_);
    estimate.error_residual = residual / std::sqrt(norm_);
    estimate.error = std::sqrt((square + bias + residual * residual) / norm_);
    estimate.error_bound = (std::sqrt(square + bias + uncertain) + residual) / std::sqrt(norm_);
  }

  void set_local(EnergyField::Estimate& estimate) const {
    const Spread local = spread(&Draw::local), above = spread(&Draw::local_above);
    double by_draws = 0;
    if (draws_.size() > 1)
      by_draws = local.mean * (upper_ratio_95(local.relative_variance, variance_of_mean(local)) - 1);
    const double bound = local.mean + std::hypot(by_draws, above.mean - local.mean);
    estimate.error_local_estimate = std::max(std::sqrt(local.mean), errors_.percentile(own_local_, kLocalLevel));
    estimate.error_local = std::max(std::sqrt(bound), errors_.percentile(own_local_, above_local_level_));
  }

  const SpectrumField& reflectance_;
  const std::vector<double>& areas_;
  const SampledSolution& solution_;
  const EnergyBalance& balance_;
  const ErrorPropagation propagation_;
  ReflectedErrors errors_;
  double norm_ = 0;            ///< Squared, of reflected radiosity.
  double deviation_norm_ = 0;  ///< Of the patches' own deviations of irradiance.
  SquareSum own_;              ///< Squared error without propagation.
  SquareSum total_;            ///< Squared standard error of the power that all patches reflect.
  double bias_ = 0, bias_variance_ = 0;
  double above_local_level_ = kLocalLevel;  ///< With the uncertainty of a percentile of so few patches.
  SpectrumField by_residual_, by_balance_;  ///< [n] Errors of the irradiance, W/m2, by these causes.
  SpectrumField own_local_;                 ///< [n] An error by all causes, without propagation of deviations.
  std::vector<Draw> draws_;
};

}  // namespace

EnergyField::Estimate estimate_error(const PatchSet& scene, const FormFactorRows& rows, const Scattering& scattering,
                                     const std::vector<double>& areas, const SampledSolution& solution,
                                     const EnergyBalance& balance) {
  return Estimator(scene, rows, scattering, areas, solution, balance)();
}

}  // namespace patchlight
