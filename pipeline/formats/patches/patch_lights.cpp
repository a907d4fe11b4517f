#include "pipeline/formats/patches/patch_lights.h"

#include <cmath>

namespace patchlight {

namespace {

constexpr double kMaxDistance = 1e12;  // m, as for surfaces
constexpr int kShape = 8;              // position, direction, inner and outer angle

void check_light(const H5Reader& reader, const PatchSet& scene, const Light& light) {
  if (light.light_group < 0 || std::size_t(light.light_group) >= scene.light_groups.size())
    reader.refuse("an index out of range", "/lights/light_group");
  for (int k = 0; k < 3; ++k) {
    if (!(light.strength[k] >= 0 && light.strength[k] <= 3.4e38f))
      reader.refuse("a negative or non-finite value", "/lights/strength");
    if (!(std::abs(light.position[k]) <= kMaxDistance))
      reader.refuse("a position that is not finite or too far away", "/lights/shape");
  }
  if (!(std::abs(light.direction.length() - 1) <= 1e-6))
    reader.refuse("a direction that is not a unit vector", "/lights/shape");
  if (!(light.inner >= 0 && light.inner <= light.outer && light.outer <= 2))
    reader.refuse("cone angles out of range", "/lights/shape");
  if (!(light.radius >= 0 && light.radius <= kMaxLightRadius)) reader.refuse("a radius out of range", "/lights/radius");
}

}  // namespace

void write_light_datasets(H5Writer& writer, const PatchSet& scene) {
  if (scene.lights.empty()) return;
  std::vector<std::string> names;
  std::vector<std::int32_t> kinds, groups;
  std::vector<float> strengths;
  std::vector<double> shapes, radii;
  bool have_radii = false;
  for (const Light& light : scene.lights) {
    names.push_back(light.name);
    kinds.push_back(std::int32_t(light.kind));
    groups.push_back(light.light_group);
    strengths.insert(strengths.end(), {light.strength.x, light.strength.y, light.strength.z});
    for (const Vec3d& v : {light.position, light.direction}) shapes.insert(shapes.end(), {v.x, v.y, v.z});
    shapes.insert(shapes.end(), {light.inner, light.outer});
    radii.push_back(light.radius);
    have_radii = have_radii || light.radius != 0;
  }
  writer.strings("/lights/name", names);
  writer.dataset<std::int32_t>("/lights/kind", kinds);
  writer.dataset<std::int32_t>("/lights/light_group", groups);
  writer.dataset<float>("/lights/strength", strengths, 3);
  writer.dataset<double>("/lights/shape", shapes, kShape);
  if (have_radii) writer.dataset<double>("/lights/radius", radii);
}

void read_light_datasets(const H5Reader& reader, PatchSet& scene) {
  if (!reader.has("/lights/name")) return;
  const std::vector<std::string> names = reader.strings("/lights/name", -1);
  const auto count = std::int64_t(names.size());
  const std::vector<std::int32_t> kinds = reader.dataset<std::int32_t>("/lights/kind", count);
  const std::vector<std::int32_t> groups = reader.dataset<std::int32_t>("/lights/light_group", count);
  const std::vector<float> strengths = reader.dataset<float>("/lights/strength", count, 3);
  const std::vector<double> shapes = reader.dataset<double>("/lights/shape", count, kShape);
  std::vector<double> radii(names.size(), 0.0);
  if (reader.has("/lights/radius")) radii = reader.dataset<double>("/lights/radius", count);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (kinds[i] < 0 || std::size_t(kinds[i]) >= Light::kKindNames.size())
      reader.refuse("an unknown kind", "/lights/kind");
    const double* shape = shapes.data() + kShape * i;
    const Light& light = scene.lights.emplace_back(
        Light{names[i], Light::Kind(kinds[i]), groups[i],
              Color(strengths[3 * i], strengths[3 * i + 1], strengths[3 * i + 2]), Vec3d(shape[0], shape[1], shape[2]),
              Vec3d(shape[3], shape[4], shape[5]), shape[6], shape[7], radii[i], -1, Vec3d(1, 0, 0)});
    check_light(reader, scene, light);
  }
}

}  // namespace patchlight
