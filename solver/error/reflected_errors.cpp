#include "solver/error/reflected_errors.h"

#include <algorithm>
#include <cmath>

#include "pipeline/model/energy_field.h"

namespace patchlight {

namespace {

constexpr double kMostBias = 1;  // relative, squared: a few dark patches do not count for their whole primitive

}  // namespace

double ReflectedErrors::squared_norm(const SpectrumField& error) const {
  double sum = 0;
  for (std::size_t i = 0; i < error.size(); ++i)
    if (is_counted(i)) sum += areas_[i] * square_at(i, error[i]);
  return sum;
}

double ReflectedErrors::squared_black() const {
  double area = 0;
  for (std::size_t i = 0; i < areas_.size(); ++i)
    if (is_counted(i) && reflectance_[i].sum() > 0) area += areas_[i];
  return area > 0 ? kBlack * kBlack * squared_norm(irradiance_) / area : 0.0;
}

void ReflectedErrors::add_bias(const IrradianceFilter& filter) {
  std::vector<double> sums(scene_.primitives.size()), areas(scene_.primitives.size());
  const double black = squared_black();
  for (std::size_t i = 0; i < areas_.size(); ++i)
    if (const double square = square_at(i, irradiance_[i]); is_counted(i) && square > black) {
      sums[scene_.patches[i].primitive] += areas_[i] * std::min(filter.bias(i).square / square, kMostBias);
      areas[scene_.patches[i].primitive] += areas_[i];
    }
  squared_bias_.resize(sums.size());
  for (std::size_t p = 0; p < sums.size(); ++p)
    if (areas[p] > 0) squared_bias_[p] += std::max(sums[p] / areas[p], 0.0);
}

double ReflectedErrors::percentile(const SpectrumField& error, double level) const {
  const double black = squared_black();
  std::vector<std::pair<double, double>> errors;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double square = square_at(i, irradiance_[i]), squared_error = square_at(i, error[i]);
    if (!is_counted(i) || square == 0 || std::max(square, squared_error) <= black) continue;
    const double bias = squared_bias_.empty() ? 0.0 : squared_bias_[scene_.patches[i].primitive];
    errors.emplace_back(std::sqrt(squared_error / square + bias), areas_[i]);
  }
  return weighted_percentile(std::move(errors), level);
}

}  // namespace patchlight
