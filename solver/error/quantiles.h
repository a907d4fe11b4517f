#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace patchlight {

inline constexpr double kNormalQuantile95 = 1.645;  ///< One-sided, in standard deviations.

/// 95% quantile of the F distribution with `numerator` and `denominator` degrees of freedom (Paulson 1942).
inline double f_quantile_95(double numerator, double denominator) {
  constexpr double kMinNumerator = 1, kMinDenominator = 4;  // from where on the approximation is accurate
  const double c = 2 / (9 * std::max(numerator, kMinNumerator)), d = 2 / (9 * std::max(denominator, kMinDenominator));
  const double z = kNormalQuantile95, a = 1 - c, b = 1 - d;
  return std::pow((a * b + z * std::sqrt(a * a * d + b * b * c - z * z * c * d)) / (b * b - z * z * d), 3);
}

/// Mean and relative variance of a sum of squares that are drawn at random.
struct Spread {
  double mean = 0.0;
  double relative_variance = 0.0;

  Spread() = default;
  explicit Spread(const std::vector<double>& draws) {
    const auto count = double(draws.size());
    for (const double x : draws) mean += x / count;
    if (mean == 0) return;
    for (const double x : draws) relative_variance += (x / mean - 1) * (x / mean - 1) / std::max(1.0, count - 1);
  }
};

/// Bound that a sum of squares of this relative variance exceeds in 5% of cases, relative to another estimate of its
/// mean, of the relative variance `known`.
inline double upper_ratio_95(double relative_variance, double known) {
  constexpr double kLeast = 1e-9;
  return f_quantile_95(2 / std::max(relative_variance, kLeast), 2 / std::max(known, kLeast));
}

}  // namespace patchlight
