#include "solver/direct/coat_light.h"

#include "solver/form_factors/coated_rows.h"

namespace patchlight {

namespace {

constexpr float kOpaque = 1e-3f;  // transmittance of a coat that hardly any ray of a row passes

Vec3d middle_of(const Primitive& primitive) {
  if (primitive.shape == Primitive::Shape::sphere) return primitive.sphere_center;
  return (primitive.corners[0] + primitive.corners[1] + primitive.corners[2] + primitive.corners[3]) / 4.0;
}

}  // namespace

CoatLight::CoatLight(const PatchSet& scene, const LightRows& lights) : scene_(scene), coats_(scene) {
  if (!any() || lights.starts.empty()) return;
  further_.resize(scene.patches.size());
  for (std::size_t i = 0; i < further_.size(); ++i) {
    double weights = 0;
    for (std::uint64_t at = lights.starts[2 * i]; at < lights.starts[2 * i + 2]; ++at) {
      const Patch& emitter = scene.patches[lights.patches[at]];
      const double weight = double(lights.weights[at]) * Spectrum(emitter.emission).sum();
      const Vec3d towards = (emitter.center - scene.patches[i].center).normalized();
      further_[i] += factor_at(i, towards ^ Vec3d(scene.patches[i].normal)) * Spectrum(weight);
      weights += weight;
    }
    if (weights > 0) further_[i] *= Spectrum(1 / weights);
  }
}

bool CoatLight::is_without(std::size_t patch) const {
  const Material& material = scene_.materials[scene_.primitives[scene_.patches[patch].primitive].material];
  return !material.is_coated() || material.specular != Color(0.0f);
}

Spectrum CoatLight::factor(const Emitter& emitter, std::size_t patch) const {
  if (is_without(patch)) return {};
  const Patch& receiver = scene_.patches[patch];
  Vec3d towards;
  if (emitter.light < 0) {
    towards = (emitter.patches == 1 ? scene_.patches[emitter.first_patch].center
                                    : middle_of(scene_.primitives[emitter.primitive])) -
              receiver.center;
  } else {
    const Light& light = scene_.lights[emitter.light];
    towards = light.kind == Light::Kind::sun ? -light.direction : light.position - receiver.center;
  }
  const double length = towards.length();
  return factor_at(patch, length > 0 ? (towards ^ Vec3d(receiver.normal)) / length : 1.0);
}

Spectrum CoatLight::factor_at(std::size_t patch, double cosine) const {
  if (is_without(patch)) return {};
  const Patch& receiver = scene_.patches[patch];
  const auto u = 0.5 * (double(receiver.u0) + double(receiver.u1)),
             v = 0.5 * (double(receiver.v0) + double(receiver.v1));
  const SpecularProperties specular = specular_properties_at(scene_, receiver.primitive, u, v);
  return for_rows(patch, coats_.at(specular, float(cosine)));
}

Spectrum CoatLight::mean_factor(std::size_t patch) const {
  if (is_without(patch)) return {};
  return for_rows(patch, Color(1.0f) - scene_.patches[patch].transmittance);
}

Spectrum CoatLight::for_rows(std::size_t patch, const Color& reflected) const {
  const Patch& receiver = scene_.patches[patch];
  const bool by_chance = passes_by_chance(scene_, scene_.primitives[receiver.primitive]);
  const Color landing = receiver.transmittance * untransmitted_part(scene_, scene_.primitives[receiver.primitive]);
  Spectrum exitance(reflected);
  for (int k = 0; by_chance && k < 3; ++k)
    exitance.c[k] = landing[k] > kOpaque ? exitance.c[k] / double(landing[k]) : 0.0;
  return exitance;
}

}  // namespace patchlight
