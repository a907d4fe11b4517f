#include "pipeline/model/energy_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patchlight {

std::vector<Color> irradiance(const EnergyField& energy, const std::vector<Color>& settings, std::size_t patches) {
  std::vector<Color> sum(patches, Color(0.0f));
  for (std::size_t g = 0; g < energy.groups.size(); ++g)
    for (std::size_t i = 0; i < patches; ++i)
      sum[i] += settings[g] * (energy.groups[g].direct[i] + energy.groups[g].indirect[i]);
  return sum;
}

std::vector<Color> irradiance(const EnergyField::Group& group) {
  std::vector<Color> sum = group.direct;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += group.indirect[i];
  return sum;
}

std::vector<Color> irradiance_without_sampled(const EnergyField::Group& group) {
  std::vector<Color> sum = group.indirect;
  for (std::size_t i = 0; i < group.gathered_direct.size(); ++i) sum[i] += group.gathered_direct[i];
  return sum;
}

std::vector<Color> radiosity(const PatchSet& scene, const EnergyField& energy) {
  std::vector<Color> result(scene.patches.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    Color irradiance(0.0f);
    for (const auto& group : energy.groups) irradiance += group.direct[i] + group.indirect[i];
    result[i] = scene.patches[i].emission + scene.patches[i].total_reflectance() * irradiance;
  }
  return result;
}

double radiosity_error(const PatchSet& scene, const EnergyField& energy, const EnergyField& reference) {
  const std::vector<Color> a = radiosity(scene, energy), b = radiosity(scene, reference);
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Patch& patch = scene.patches[i];
    if (patch.emission != Color(0.0f)) continue;
    difference += patch.covered_area() * double((a[i] - b[i]).length2());
    norm += patch.covered_area() * double(b[i].length2());
  }
  if (difference == 0) return 0;
  return norm > 0 ? std::sqrt(difference / norm) : std::numeric_limits<double>::infinity();
}

double weighted_percentile(std::vector<std::pair<double, double>> weighted, double level) {
  std::sort(weighted.begin(), weighted.end());
  double total = 0, sum = 0;
  for (const auto& [value, weight] : weighted) total += weight;
  for (const auto& [value, weight] : weighted)
    if ((sum += weight) >= level * total) return value;
  return weighted.empty() ? 0.0 : weighted.back().first;
}

double local_radiosity_error(const PatchSet& scene, const EnergyField& energy, const EnergyField& reference) {
  const std::vector<Color> a = radiosity(scene, energy), b = radiosity(scene, reference);
  const auto is_counted = [&](std::size_t i) {
    const Patch& patch = scene.patches[i];
    return patch.emission == Color(0.0f) && patch.reflectance != Color(0.0f);
  };
  double square = 0, area = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (!is_counted(i)) continue;
    square += scene.patches[i].covered_area() * double(b[i].length2());
    area += scene.patches[i].covered_area();
  }
  const double black = area > 0 ? kBlack * std::sqrt(square / area) : 0.0;
  std::vector<std::pair<double, double>> errors;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_counted(i)) continue;
    const double difference = (a[i] - b[i]).length(), reflected = b[i].length();
    if (std::max(difference, reflected) <= black) continue;
    errors.emplace_back(difference == 0 ? 0.0 : difference / reflected, scene.patches[i].covered_area());
  }
  return weighted_percentile(std::move(errors), 0.95);
}

}  // namespace patchlight
