#include "tracer/light/lamps/glossy_lights.h"

#include <algorithm>

#include "pipeline/optics/surface/mirror.h"
#include "pipeline/optics/surface/smooth_normals.h"

namespace patchlight {

namespace {

/// The mirrors that reflect as they are modelled for images: no others in normals or colours.
std::vector<PlaneMirror> exact_mirrors(const PatchSet& scene, const RayScene& ray_scene) {
  std::vector<PlaneMirror> mirrors = plane_mirrors(scene, ray_scene);
  const SmoothNormals normals(scene);
  std::erase_if(mirrors, [&](const PlaneMirror& mirror) {
    const Primitive& p = scene.primitives[mirror.primitive()];
    return p.normal_texture >= 0 || !normals.is_flat(mirror.primitive()) || scene.materials[p.material].coat.exists();
  });
  return mirrors;
}

}  // namespace

GlossyLights::GlossyLights(const PatchSet& scene, const RayScene& ray_scene, const ExplicitLights& lights,
                           const FurtherLight& further)
    : lights_(lights),
      further_(further),
      mirrors_(exact_mirrors(scene, ray_scene)),
      lamp_of_patch_(scene.patches.size(), -1),
      further_of_patch_(lamp_of_patch_) {
  for (std::size_t l = 0; l < lights.lamps().size(); ++l) {
    const ExplicitLights::Lamp& lamp = lights.lamps()[l];
    const Emitter& emitter = lamp.emitter;
    std::fill_n(lamp_of_patch_.begin() + emitter.first_patch, emitter.patches, std::int32_t(l));
    const Light* const light = emitter.light >= 0 ? &scene.lights[emitter.light] : nullptr;
    const bool is_sun = light && light->kind == Light::Kind::sun;
    sources_.push_back({&lamp, lamp.light, -1, is_sun ? -light->direction : Vec3d(0.0), lamp.brightness()});
  }
  for (std::size_t m = 0; m < mirrors_.size(); ++m)
    for (std::size_t l = 0; l < lights.lamps().size(); ++l) {
      const Color seen = lights.lamps()[l].unscaled * mirrors_[m].specular();
      sources_.push_back({&lights.lamps()[l], sources_[l].light.image(mirrors_[m]), std::int32_t(m),
                          mirrors_[m].reflect(sources_[l].sun), seen.x + seen.y + seen.z});
    }
  const std::vector<Emitter>& emitters = further.lights().emitters();
  for (std::size_t l = 0; l < emitters.size(); ++l)
    std::fill_n(further_of_patch_.begin() + emitters[l].first_patch, emitters[l].patches, std::int32_t(l));
}

std::int32_t GlossyLights::mirror(std::int32_t primitive) const {
  for (std::size_t m = 0; m < mirrors_.size(); ++m)
    if (mirrors_[m].primitive() == primitive) return std::int32_t(m);
  return -1;
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
  for (const Source& source : sources_) {
    float weight = 0;
    if (source.brightness > 0 && (source.mirror < 0 || mirrors_[source.mirror].is_before(vertex.position)))
      weight = source.brightness * float(source.light.apparent_size(vertex.position));
    if (weight > 0) {
      const bool is_sun = source.sun != Vec3d(0.0);
      const Vec3d towards = is_sun ? source.sun : source.light.center() - vertex.position;
      const double distance = towards.length();
      const float extent = is_sun ? 0.0f : float(std::min(1.0, source.light.radius() / std::max(distance, 1e-30)));
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
  return sample_lamp(sources_[l], vertex, at, weights[l] / sum);
}

/// `probability`: of the source.
GlossyLights::Sample GlossyLights::sample_lamp(const Source& source, const Vertex& vertex, const Vec2f& at,
                                               float probability) const {
  const ExplicitLights::Lamp& lamp = *source.lamp;
  const DirectLight::View view = source.light.view(vertex.position, vertex.normal);
  const DirectLight::Sample ray = view.sample(at.x, at.y);
  if (ray.weight <= 0) return {};
  Sample sample{ray.direction, ray.distance, 0.0f, lamp.group, lamp.unscaled};
  if (source.mirror >= 0) {
    const PlaneMirror& mirror = mirrors_[source.mirror];
    const auto crossing = mirror.crossing(vertex.position, ray.direction);
    if (!crossing || crossing->leaves >= ray.distance) return {};
    sample.distance = crossing->arrives;
    sample.exitance *= mirror.specular();
    sample.reflected = {crossing->position, crossing->direction, ray.distance - crossing->leaves};
  }
  const SpecularLobe lobe = specular_lobe(vertex.roughness, vertex.normal, vertex.direction, ray.direction);
  if (lamp.emitter.light >= 0) {  // no path hits it
    const auto irradiance = float(kPi * view.perpendicular_weight(ray));
    sample.weight = lobe.value * irradiance / probability;
    return sample;
  }
  const float density = float(view.density(ray.direction)) * probability;
  if (density > 0 && lobe.value > 0) sample.weight = lobe.value / (density + lobe.density);
  return sample;
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

float GlossyLights::hit_weight(const Vertex& vertex, const Vec3f& direction, float pdf, std::int32_t patch,
                               std::int32_t mirror) const {
  const std::int32_t l = lamp_of_patch_[patch], f = mirror < 0 ? further_of_patch_[patch] : -1;
  if (l < 0 && f < 0) return 1.0f;
  thread_local std::vector<float> weights;
  const float further = further_weight(vertex), sum = selection_weights(vertex, weights) + further;
  if (sum <= 0) return 1.0f;
  const std::size_t source = std::size_t(l) + std::size_t(mirror + 1) * lights_.lamps().size();
  const DirectLight& light = l >= 0 ? sources_[source].light : further_.lights().light(f);
  const Vec3f left = mirror < 0 ? direction : Vec3f(mirrors_[mirror].reflect(Vec3d(direction)));
  double density = light.view(vertex.position, vertex.normal).density(left);
  if (l >= 0)
    density *= double(weights[source]);
  else if (density > 0)
    density *= further_.lights().tree().probability(f, {vertex.position, 0.0, Vec3d(vertex.normal)}) * double(further);
  return pdf / (pdf + float(density) / sum);
}

}  // namespace patchlight
