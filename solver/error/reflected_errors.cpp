#include "solver/error/reflected_errors.h"

#include <algorithm>
#include <cmath>

#include "pipeline/model/energy_field.h"

namespace patchlight {

double ReflectedErrors::squared_norm(const SpectrumField& error) const {
  double sum = 0;
  for (std::size_t i = 0; i < error.size(); ++i)
    if (is_counted(i)) sum += areas_[i] * square_at(i, error[i]);
  return sum;
}

void ReflectedErrors::add_bias(const IrradianceFilter& filter) {
  std::vector<double> sums(scene_.primitives.size()), areas(scene_.primitives.size());
  for (std::size_t i = 0; i < areas_.size(); ++i)
    if (const double square = square_at(i, irradiance_[i]); is_counted(i) && square > 0) {
      sums[scene_.patches[i].primitive] += areas_[i] * filter.bias(i).square / square;
      areas[scene_.patches[i].primitive] += areas_[i];
    }
  squared_bias_.resize(sums.size());
  for (std::size_t p = 0; p < sums.size(); ++p)
    if (areas[p] > 0) squared_bias_[p] += std::max(sums[p] / areas[p], 0.0);
}

double ReflectedErrors::percentile(const SpectrumField& error, double level) const {
  std::vector<std::pair<double, double>> errors;
  for (std::size_t i = 0; i < error.size(); ++i)
    if (const double square = square_at(i, irradiance_[i]); is_counted(i) && square > 0) {
      const double bias = squared_bias_.empty() ? 0.0 : squared_bias_[scene_.patches[i].primitive];
      errors.emplace_back(std::sqrt(square_at(i, error[i]) / square + bias), areas_[i]);
    }
  return weighted_percentile(std::move(errors), level);
}

}  // namespace patchlight
