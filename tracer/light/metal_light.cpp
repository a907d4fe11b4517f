#include "tracer/light/metal_light.h"

#include <algorithm>

#include "pipeline/optics/surface/mirror.h"

namespace patchlight {

MetalLight::MetalLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings)
    : lights_(scene, ray_scene, settings), lamp_of_(scene.patches.size(), -1) {
  for (std::size_t l = 0; l < lights_.lamps().size(); ++l) {
    const PixelLight::Lamp& lamp = lights_.lamps()[l];
    std::fill_n(lamp_of_.begin() + lamp.emitter.first_patch, lamp.emitter.patches, std::int32_t(l));
  }
}

bool MetalLight::is_of_use(const PatchSet& scene) {
  return std::any_of(scene.primitives.begin(), scene.primitives.end(), [&](const Primitive& p) {
    const Material& material = scene.materials[p.material];
    return material.specular != Color(0.0f) &&
           (material.roughness >= kMirrorRoughness || p.metallic_roughness_texture >= 0);
  });
}

float MetalLight::chances(const Vec3d& position, std::vector<float>& of_lamps) const {
  float sum = 0;
  of_lamps.clear();
  for (const PixelLight::Lamp& lamp : lights_.lamps()) {
    of_lamps.push_back(lamp.brightness() * float(lamp.light.apparent_size(position)));
    sum += of_lamps.back();
  }
  return sum;
}

MetalLight::Sample MetalLight::sample(const Place& place, float choice, const Vec2f& at) const {
  thread_local std::vector<float> of_lamps;
  const float sum = chances(place.position, of_lamps);
  if (sum <= 0) return {};
  std::size_t l = 0;
  float left = choice * sum;
  while (l + 1 < of_lamps.size() && left >= of_lamps[l]) left -= of_lamps[l++];
  const PixelLight::Lamp& lamp = lights_.lamps()[l];
  const DirectLight::View view = lamp.light.view(place.position, place.normal);
  const DirectLight::Sample ray = view.sample(at.x, at.y);
  if (ray.weight <= 0) return {};
  const MetalLobe lobe = metal_lobe(place.roughness, place.normal, place.direction, ray.direction);
  if (lamp.emitter.light >= 0) {  // no path meets it
    const auto arriving = float(kPi * lamp.light.perpendicular_factor(place.position));
    return {ray.direction, ray.distance, lobe.value * arriving * sum / of_lamps[l], &lamp};
  }
  const float density = float(view.density(ray.direction)) * of_lamps[l] / sum;
  if (density <= 0 || lobe.value <= 0) return {};
  return {ray.direction, ray.distance, lobe.value / (density + lobe.density), &lamp};
}

float MetalLight::part_hit(const Place& place, const Vec3f& direction, float density, std::int32_t patch) const {
  const std::int32_t l = lamp_of_[patch];
  if (l < 0) return 1.0f;
  thread_local std::vector<float> of_lamps;
  const float sum = chances(place.position, of_lamps);
  const double by_lamp = lights_.lamps()[l].light.view(place.position, place.normal).density(direction);
  return sum > 0 ? density / (density + float(by_lamp) * of_lamps[l] / sum) : 1.0f;
}

}  // namespace patchlight
