#include "solver/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/random.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

namespace {

constexpr int kDraws = 8;        // where errors reach other patches
constexpr double kLocal = 0.05;  // part of an error that may come from other patches before that counts
constexpr double kSpreadTolerance = 0.05;
constexpr int kSpreadIterations = 100;

Spectrum root(const Spectrum& s) {
  Spectrum result;
  for (int k = 0; k < 3; ++k) result.c[k] = std::sqrt(s.c[k]);
  return result;
}

Spectrum signed_by(const Spectrum& s, bool negative) {
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
    for (std::size_t i = 0; i < n; ++i) {
      const Spectrum& a = solution_.deviation[i];
      const Spectrum& b = solution_.direct_deviation[i];
      const Spectrum square = (a * a + b * b) * reflectance_[i] * reflectance_[i];
      const Spectrum deviation = root(square);
      estimate.deviation.emplace_back(float(deviation.c[0]), float(deviation.c[1]), float(deviation.c[2]));
      norm += squared_at(i, solution_.irradiance);
      if (!counts(i)) continue;
      local += areas_[i] * square.sum();
      double correlated = 1;
      for (const IrradianceFilter* filter : solution_.filters) {
        bias += areas_[i] * filter->bias(i).square;
        bias_variance += areas_[i] * areas_[i] * filter->bias(i).variance;
        correlated = std::max(correlated, filter->correlated(i));
      }
      spread += areas_[i] * areas_[i] * square.sum() * square.sum() * correlated;
    }
    if (norm == 0) return estimate;
    // Half a row's square is itself as scattered as a square of a normal variate, and so is the true error's.
    double relative_spread = local > 0 ? std::sqrt(2 * 2 * spread) / local : 0.0;
    double square = local;
    if (local > 0) {
      std::vector<double> draws{draw(0)};
      if (std::abs(std::sqrt(draws[0] / local) - 1) > kLocal) {
        while (int(draws.size()) < kDraws) draws.push_back(draw(draws.size()));
        double mean = 0, variance = 0;
        for (const double d : draws) mean += d / kDraws;
        for (const double d : draws) variance += (d - mean) * (d - mean) / (kDraws - 1);
        square = std::max(mean, local);
        relative_spread = std::max(relative_spread, std::sqrt(2 * variance) / mean);
      }
    }
    constexpr double kOneIn20 = 1.645;
    const double uncertain = std::sqrt(square * square * relative_spread * relative_spread + bias_variance);
    square += std::max(bias, 0.0);
    estimate.error = std::sqrt(square / norm);
    estimate.error_bound = std::sqrt((square + kOneIn20 * uncertain) / norm) + solution_.residual;
    return estimate;
  }

 private:
  bool counts(std::size_t i) const { return scene_.patches[i].emission == Color(0.0f); }

  double squared_at(std::size_t i, const SpectrumField& irradiance) const {
    const Spectrum reflected = reflectance_[i] * irradiance[i];
    return counts(i) ? areas_[i] * (reflected * reflected).sum() : 0.0;
  }

  /// Squared norm of an error as likely as the true one.
  double draw(std::uint64_t index) const {
    SpectrumField source(areas_.size());
    for (std::size_t i = 0; i < source.size(); ++i) {
      const std::uint64_t random = scramble(scramble(index) + i);
      source[i] = signed_by(solution_.deviation[i], random & 1) + signed_by(solution_.direct_deviation[i], random & 2);
    }
    SpectrumField error = source;
    solve_irradiance(rows_, reflectance_, areas_, source, kSpreadTolerance, kSpreadIterations, error,
                     [](double) { Progress::check_interrupted(); });
    double square = 0;
    for (std::size_t i = 0; i < error.size(); ++i) square += squared_at(i, error);
    return square;
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
