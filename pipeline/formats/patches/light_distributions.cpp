#include "pipeline/formats/patches/light_distributions.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

constexpr int kShapeColumns = 3;                // system, numbers of vertical and horizontal angles
constexpr double kMaxDistributionAngle = 1000;  // degrees

void check_angles(const H5Reader& reader, const std::vector<double>& angles) {
  for (std::size_t k = 0; k < angles.size(); ++k)
    if (!(std::abs(angles[k]) <= kMaxDistributionAngle) || (k > 0 && !(angles[k] > angles[k - 1])))
      reader.refuse("angles out of range or order", "/distributions/angle");
}

void read_lights(const H5Reader& reader, PatchSet& scene) {
  const auto lights = std::int64_t(scene.lights.size());
  const std::vector<std::int32_t> indices = reader.dataset<std::int32_t>("/lights/distribution", lights);
  const std::vector<double> across = reader.dataset<double>("/lights/across", lights, 3);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    Light& light = scene.lights[i];
    light.distribution = indices[i];
    light.across = {across[3 * i], across[3 * i + 1], across[3 * i + 2]};
    const bool is_index = indices[i] >= -1 && indices[i] < std::int32_t(scene.distributions.size());
    if (!is_index || (indices[i] >= 0 && light.kind != Light::Kind::point))
      reader.refuse("an index out of range", "/lights/distribution");
    if (!(std::abs(light.across.length() - 1) <= 1e-6))
      reader.refuse("a direction that is not a unit vector", "/lights/across");
  }
}

}  // namespace

void write_distribution_datasets(H5Writer& writer, const PatchSet& scene) {
  const auto has_one = [](const Light& light) { return light.distribution >= 0; };
  if (std::none_of(scene.lights.begin(), scene.lights.end(), has_one)) return;
  std::vector<std::int32_t> shapes, indices;
  std::vector<double> angles, across;
  std::vector<float> intensities;
  for (const LightDistribution& one : scene.distributions) {
    shapes.insert(shapes.end(),
                  {std::int32_t(one.system), std::int32_t(one.vertical.size()), std::int32_t(one.horizontal.size())});
    angles.insert(angles.end(), one.vertical.begin(), one.vertical.end());
    angles.insert(angles.end(), one.horizontal.begin(), one.horizontal.end());
    intensities.insert(intensities.end(), one.intensity.begin(), one.intensity.end());
  }
  for (const Light& light : scene.lights) {
    indices.push_back(light.distribution);
    across.insert(across.end(), {light.across.x, light.across.y, light.across.z});
  }
  writer.dataset<std::int32_t>("/distributions/shape", shapes, kShapeColumns);
  writer.dataset<double>("/distributions/angle", angles);
  writer.dataset<float>("/distributions/intensity", intensities);
  writer.dataset<std::int32_t>("/lights/distribution", indices);
  writer.dataset<double>("/lights/across", across, 3);
}

void read_distribution_datasets(const H5Reader& reader, PatchSet& scene) {
  if (!reader.has("/distributions/shape")) return;
  const std::vector<std::int32_t> shapes = reader.dataset<std::int32_t>("/distributions/shape", -1, kShapeColumns);
  const std::vector<double> angles = reader.dataset<double>("/distributions/angle", -1);
  const std::vector<float> intensities = reader.dataset<float>("/distributions/intensity", -1);
  std::size_t next_angle = 0, next_intensity = 0;
  for (std::size_t i = 0; i < shapes.size(); i += kShapeColumns) {
    if (shapes[i] < 1 || shapes[i] > 3 || shapes[i + 1] < 1 || shapes[i + 2] < 1)
      reader.refuse("an unknown system, or no angles", "/distributions/shape");
    const std::size_t vertical = std::size_t(shapes[i + 1]), horizontal = std::size_t(shapes[i + 2]);
    if (vertical + horizontal > angles.size() - next_angle ||
        vertical * horizontal > intensities.size() - next_intensity)
      reader.refuse("more angles than there are", "/distributions/shape");
    LightDistribution& one = scene.distributions.emplace_back();
    one.system = LightDistribution::System(shapes[i]);
    const auto angle = angles.begin() + std::ptrdiff_t(next_angle);
    one.vertical.assign(angle, angle + std::ptrdiff_t(vertical));
    one.horizontal.assign(angle + std::ptrdiff_t(vertical), angle + std::ptrdiff_t(vertical + horizontal));
    check_angles(reader, one.vertical);
    check_angles(reader, one.horizontal);
    next_angle += vertical + horizontal;
    const auto value = intensities.begin() + std::ptrdiff_t(next_intensity);
    one.intensity.assign(value, value + std::ptrdiff_t(vertical * horizontal));
    next_intensity += vertical * horizontal;
    for (const float intensity : one.intensity)
      if (!(intensity >= 0 && intensity <= 1)) reader.refuse("a value out of range", "/distributions/intensity");
  }
  if (next_angle != angles.size() || next_intensity != intensities.size())
    reader.refuse("fewer angles or values than there are", "/distributions/shape");
  read_lights(reader, scene);
}

}  // namespace patchlight
