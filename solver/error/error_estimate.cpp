#include "solver/error/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

namespace {

constexpr int kDraws = 8;                // bootstrap draws where errors propagate between patches
constexpr double kMaxPropagated = 0.05;  // relative change of an error by propagation that one draw is enough for
constexpr double kSpreadTolerance = 0.05;
constexpr int kSpreadIterations = 100;
constexpr double kNormalQuantile95 = 1.645;  // one-sided, in standard deviations

/// 95% quantile of the F distribution with `freedom` degrees of freedom each (Paulson 1942).
double f_quantile_95(double freedom) {
  constexpr double kMinFreedom = 8;  // from where on the approximation is accurate
  const double c = 2 / (9 * std::max(freedom, kMinFreedom)), a = (1 - c) * (1 - c),
               b = a - kNormalQuantile95 * kNormalQuantile95 * c;
  return std::pow((a + std::sqrt(a * a - b * b)) / b, 3);
}

Spectrum root(const Spectrum& s) {
  Spectrum result;
  for (int k = 0; k < 3; ++k) result.c[k] = std::sqrt(s.c[k]);
  return result;
}

Spectrum with_sign(const Spectrum& s, bool negative) {
  return s * Spectrum(negative ? -1.0 : 1.0);
}

class Estimator {
 public:
  Estimator(const PatchSet& scene, const FormFactorRows& rows, const SpectrumField& reflectance,
            const std::vector<double>& areas, const SampledSolution& solution)
      : scene_(scene), rows_(rows), reflectance_(reflectance), areas_(areas), solution_(solution) {}

  EnergyField::Estimate operator()() const {
    EnergyField::Estimate estimate;
    const std::size_t n = areas_.size();
    double norm = 0, local = 0, spread = 0, bias = 0, bias_variance = 0;
    std::vector<SpectrumField> filtered_deviations;
    for (const auto& part : solution_.filtered) filtered_deviations.push_back(part.filter->apply(part.deviation));
    for (std::size_t i = 0; i < n; ++i) {
      Spectrum square = solution_.deviation[i] * solution_.deviation[i];
      for (const SpectrumField& field : filtered_deviations) square += field[i] * field[i];
      square *= reflectance_[i] * reflectance_[i];
      const Spectrum deviation = root(square);
      estimate.deviation.emplace_back(float(deviation.c[0]), float(deviation.c[1]), float(deviation.c[2]));
      norm += squared_at(i, solution_.irradiance);
      if (!is_counted(i)) continue;
      local += areas_[i] * square.sum();
      double correlated = 1;
      for (const auto& part : solution_.filtered) {
        bias += areas_[i] * part.filter->bias(i).square;
        bias_variance += areas_[i] * areas_[i] * part.filter->bias(i).variance;
        correlated = std::max(correlated, part.filter->correlated_patches(i));
      }
      spread += areas_[i] * areas_[i] * square.sum() * square.sum() * correlated;
    }
    if (norm == 0) return estimate;
    // Each squared deviation varies as the square of a normal variate, and so does the squared true error.
    double relative_spread = local > 0 ? std::sqrt(2 * 2 * spread) / local : 0.0;
    double square = local;
    if (local > 0) {
      // Relative to the squares of the local errors, one draw already shows how much propagates to other patches.
      std::vector<double> draws{local * draw(0)};
      if (std::abs(std::sqrt(draws[0] / local) - 1) > kMaxPropagated)
        while (int(draws.size()) < kDraws) draws.push_back(local * draw(draws.size()));
      double mean = 0, variance = 0;
      for (const double d : draws) mean += d / double(draws.size());
      for (const double d : draws) variance += (d - mean) * (d - mean) / std::max(1.0, double(draws.size()) - 1);
      square = std::max(mean, local);
      relative_spread = std::max(relative_spread, std::sqrt(2 * variance) / mean);
    }
    const double above = square * (f_quantile_95(4 / (relative_spread * relative_spread)) - 1);
    const double uncertain = std::sqrt(above * above + kNormalQuantile95 * kNormalQuantile95 * bias_variance);
    square += std::max(bias, 0.0);
    estimate.error = std::sqrt(square / norm);
    estimate.error_bound = std::sqrt((square + uncertain) / norm) + solution_.residual;
    return estimate;
  }

 private:
  bool is_counted(std::size_t i) const { return scene_.patches[i].emission == Color(0.0f); }

  double squared_at(std::size_t i, const SpectrumField& irradiance) const {
    const Spectrum reflected = reflectance_[i] * irradiance[i];
    return is_counted(i) ? areas_[i] * (reflected * reflected).sum() : 0.0;
  }

  /// Squared norm of a random error with its propagation to other patches, over its squared norm without.
  double draw(std::uint64_t index) const {
    const auto with_random_signs = [&](const SpectrumField& deviation, std::uint64_t bit) {
      SpectrumField drawn;
      drawn.reserve(areas_.size());
      for (std::size_t i = 0; i < areas_.size(); ++i)
        drawn.push_back(with_sign(deviation[i], hash64(hash64(index) + i) >> bit & 1));
      return drawn;
    };
    SpectrumField source = with_random_signs(solution_.deviation, 0);
    // Filtered deviations are correlated between patches: filter the signed ones alike.
    for (std::size_t k = 0; k < solution_.filtered.size(); ++k) {
      const auto& part = solution_.filtered[k];
      const SpectrumField smooth = part.filter->apply(with_random_signs(part.deviation, k + 1));
      for (std::size_t i = 0; i < source.size(); ++i) source[i] += smooth[i];
    }
    std::vector<SpectrumField> error{source};
    solve_irradiance(rows_, reflectance_, areas_, {source}, kSpreadTolerance, kSpreadIterations, error,
                     [](double) { Progress::check_interrupted(); });
    double square = 0, source_square = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      square += squared_at(i, error[0]);
      source_square += squared_at(i, source);
    }
    return source_square > 0 ? square / source_square : 1.0;
  }

  const PatchSet& scene_;
  const FormFactorRows& rows_;
  const SpectrumField& reflectance_;
  const std::vector<double>& areas_;
  const SampledSolution& solution_;
};

}  // namespace

EnergyField::Estimate estimate_error(const PatchSet& scene, const FormFactorRows& rows,
                                     const SpectrumField& reflectance, const std::vector<double>& areas,
                                     const SampledSolution& solution) {
  return Estimator(scene, rows, reflectance, areas, solution)();
}

}  // namespace patchlight
