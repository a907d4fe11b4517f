#include "tracer/light/lamps/glossy_lights.h"

#include <algorithm>

#include "pipeline/optics/surface/mirror.h"

namespace patchlight {

GlossyLights::GlossyLights(const PatchSet& scene, const ExplicitLights& lights, const FurtherLight& further)
    : lights_(lights), further_(further), lamp_of_patch_(scene.patches.size(), -1), further_of_patch_(lamp_of_patch_) {
  for (std::size_t l = 0; l < lights.lamps().size(); ++l) {
    const Emitter& emitter = lights.lamps()[l].emitter;
    std::fill_n(lamp_of_patch_.begin() + emitter.first_patch, emitter.patches, std::int32_t(l));
    const Light* const light = emitter.light >= 0 ? &scene.lights[emitter.light] : nullptr;
    suns_.push_back(light && light->kind == Light::Kind::sun ? -light->direction : Vec3d(0.0));
  }
  const std::vector<Emitter>& emitters = further.lights().emitters();
  for (std::size_t l = 0; l < emitters.size(); ++l)
    std::fill_n(further_of_patch_.begin() + emitters[l].first_patch, emitters[l].patches, std::int32_t(l));
}

bool GlossyLights::is_needed(const PatchSet& scene) {
  return std::any_of(scene.primitives.begin(), scene.primitives.end(), [&](const Primitive& p) {
    const Material& material = scene.materials[p.material];
    return is_specular(material) &&
           (material.roughness >= kMirrorRoughness || material.clear_coat.roughness >= kMirrorRoughness ||
            p.metallic_roughness_texture >= 0);
  });
}

float GlossyLights::selection_weights(const Vertex& vertex, std::vector<float>& weights) const {
  constexpr float kOutOfLobe = 0.05f;  // weight of a lamp whose middle is outside of the lobe
  constexpr float kExtent = 0.5f;      // the same, of a lamp that is as large as it is far
  float sum = 0;
  weights.clear();
  for (std::size_t l = 0; l < lights_.lamps().size(); ++l) {
    const ExplicitLights::Lamp& lamp = lights_.lamps()[l];
    float weight = lamp.brightness() * float(lamp.light.apparent_size(vertex.position));
    if (weight > 0) {
      const bool is_sun = suns_[l] != Vec3d(0.0);
      const Vec3d towards = is_sun ? suns_[l] : lamp.light.center() - vertex.position;
      const double distance = towards.length();
      const float extent = is_sun ? 0.0f : float(std::min(1.0, lamp.light.radius() / std::max(distance, 1e-30)));
      float lobe = 0;
      if (extent < 1)
        lobe = specular_lobe(vertex.roughness, vertex.normal, vertex.direction, Vec3f(towards / distance)).value;
      weight *= kOutOfLobe + kExtent * extent + lobe;
    }
    weights.push_back(weight);
    sum += weight;
  }
  return sum;
}

float GlossyLights::further_weight(const Vertex& vertex) const {
  return float(further_.lights().tree().importance({vertex.position, 0.0, Vec3d(vertex.normal)}) / kPi);
}

GlossyLights::Sample GlossyLights::sample(const Vertex& vertex, float choice, const Vec2f& at) const {
  thread_local std::vector<float> weights;
  const float further = further_weight(vertex), sum = selection_weights(vertex, weights) + further;
  if (sum <= 0) return {};
  float remainder = choice * sum;
  if (remainder < further || weights.empty())
    return sample_further(vertex, std::min(double(remainder / further), 1.0 - 1e-9), at, further / sum);
  remainder -= further;
  std::size_t l = 0;
  while (l + 1 < weights.size() && remainder >= weights[l]) remainder -= weights[l++];
  const ExplicitLights::Lamp& lamp = lights_.lamps()[l];
  const DirectLight::View view = lamp.light.view(vertex.position, vertex.normal);
  const DirectLight::Sample ray = view.sample(at.x, at.y);
  if (ray.weight <= 0) return {};
  const SpecularLobe lobe = specular_lobe(vertex.roughness, vertex.normal, vertex.direction, ray.direction);
  if (lamp.emitter.light >= 0) {  // no path hits it
    const auto irradiance = float(kPi * view.perpendicular_weight(ray));
    return {ray.direction, ray.distance, lobe.value * irradiance * sum / weights[l], lamp.group, lamp.unscaled};
  }
  const float density = float(view.density(ray.direction)) * weights[l] / sum;
  if (density <= 0 || lobe.value <= 0) return {};
  return {ray.direction, ray.distance, lobe.value / (density + lobe.density), lamp.group, lamp.unscaled};
}

/// `part`: probability of further lights.
GlossyLights::Sample GlossyLights::sample_further(const Vertex& vertex, double choice, const Vec2f& at,
                                                  float part) const {
  const auto [l, probability] = further_.lights().tree().choose({vertex.position, 0.0, Vec3d(vertex.normal)}, choice);
  if (probability <= 0) return {};
  const DirectLight::View view = further_.lights().light(l).view(vertex.position, vertex.normal);
  const DirectLight::Sample ray = view.sample(at.x, at.y);
  if (ray.weight <= 0) return {};
  const SpecularLobe lobe = specular_lobe(vertex.roughness, vertex.normal, vertex.direction, ray.direction);
  const float density = float(view.density(ray.direction) * probability) * part;
  if (density <= 0 || lobe.value <= 0) return {};
  return {ray.direction, ray.distance, lobe.value / (density + lobe.density), further_.group(l),
          further_.exitance(l, vertex.position, ray)};
}

float GlossyLights::hit_weight(const Vertex& vertex, const Vec3f& direction, float pdf, std::int32_t patch) const {
  const std::int32_t l = lamp_of_patch_[patch], f = further_of_patch_[patch];
  if (l < 0 && f < 0) return 1.0f;
  thread_local std::vector<float> weights;
  const float further = further_weight(vertex), sum = selection_weights(vertex, weights) + further;
  if (sum <= 0) return 1.0f;
  const DirectLight& light = l >= 0 ? lights_.lamps()[l].light : further_.lights().light(f);
  double density = light.view(vertex.position, vertex.normal).density(direction);
  if (l >= 0)
    density *= double(weights[l]);
  else if (density > 0)
    density *= further_.lights().tree().probability(f, {vertex.position, 0.0, Vec3d(vertex.normal)}) * double(further);
  return pdf / (pdf + float(density) / sum);
}

}  // namespace patchlight
