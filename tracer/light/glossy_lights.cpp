#include "tracer/light/glossy_lights.h"

#include <algorithm>

#include "pipeline/optics/surface/mirror.h"

namespace patchlight {

GlossyLights::GlossyLights(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings)
    : lights_(scene, ray_scene, settings), lamp_of_patch_(scene.patches.size(), -1) {
  for (std::size_t l = 0; l < lights_.lamps().size(); ++l) {
    const ExplicitLights::Lamp& lamp = lights_.lamps()[l];
    std::fill_n(lamp_of_patch_.begin() + lamp.emitter.first_patch, lamp.emitter.patches, std::int32_t(l));
  }
}

bool GlossyLights::is_needed(const PatchSet& scene) {
  return std::any_of(scene.primitives.begin(), scene.primitives.end(), [&](const Primitive& p) {
    const Material& material = scene.materials[p.material];
    return material.specular != Color(0.0f) &&
           (material.roughness >= kMirrorRoughness || p.metallic_roughness_texture >= 0);
  });
}

float GlossyLights::selection_weights(const Vec3d& position, std::vector<float>& weights) const {
  float sum = 0;
  weights.clear();
  for (const ExplicitLights::Lamp& lamp : lights_.lamps()) {
    weights.push_back(lamp.brightness() * float(lamp.light.apparent_size(position)));
    sum += weights.back();
  }
  return sum;
}

GlossyLights::Sample GlossyLights::sample(const Vertex& vertex, float choice, const Vec2f& at) const {
  thread_local std::vector<float> weights;
  const float sum = selection_weights(vertex.position, weights);
  if (sum <= 0) return {};
  std::size_t l = 0;
  float remainder = choice * sum;
  while (l + 1 < weights.size() && remainder >= weights[l]) remainder -= weights[l++];
  const ExplicitLights::Lamp& lamp = lights_.lamps()[l];
  const DirectLight::View view = lamp.light.view(vertex.position, vertex.normal);
  const DirectLight::Sample ray = view.sample(at.x, at.y);
  if (ray.weight <= 0) return {};
  const MetalLobe lobe = metal_lobe(vertex.roughness, vertex.normal, vertex.direction, ray.direction);
  if (lamp.emitter.light >= 0) {  // no path hits it
    const auto irradiance = float(kPi * lamp.light.perpendicular_factor(vertex.position));
    return {ray.direction, ray.distance, lobe.value * irradiance * sum / weights[l], &lamp};
  }
  const float density = float(view.density(ray.direction)) * weights[l] / sum;
  if (density <= 0 || lobe.value <= 0) return {};
  return {ray.direction, ray.distance, lobe.value / (density + lobe.density), &lamp};
}

float GlossyLights::hit_weight(const Vertex& vertex, const Vec3f& direction, float pdf, std::int32_t patch) const {
  const std::int32_t l = lamp_of_patch_[patch];
  if (l < 0) return 1.0f;
  thread_local std::vector<float> weights;
  const float sum = selection_weights(vertex.position, weights);
  const double lamp_density = lights_.lamps()[l].light.view(vertex.position, vertex.normal).density(direction);
  return sum > 0 ? pdf / (pdf + float(lamp_density) * weights[l] / sum) : 1.0f;
}

}  // namespace patchlight
