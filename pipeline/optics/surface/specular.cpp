#include "pipeline/optics/surface/specular.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

Color SpecularProperties::reflectance(float cosine) const {
  if (!has_coat()) return metal;
  return metal + coat + (Color(coat_grazing) - coat) * fresnel_rise(coat_ior, cosine);
}

SpecularProperties SpecularProperties::clear_layer() const {
  constexpr float kIor = 1.5f, kNormal = 0.04f;
  return {Color(0.0f), clear_coat.roughness, Color(kNormal * clear_coat.part), clear_coat.part, kIor};
}

SpecularProperties SpecularProperties::below() const {
  SpecularProperties result = *this;
  result.clear_coat = {};
  return result;
}

SpecularProperties specular_properties_at(const PatchSet& scene, std::int32_t i, double u, double v) {
  const Primitive& primitive = scene.primitives[i];
  const Material& material = scene.materials[primitive.material];
  SpecularProperties result{material.specular, material.roughness};
  result.clear_coat = material.clear_coat;
  float metalness = material.coat.metallic;
  const bool varies = has_varying_metal(scene, i);
  if (varies) result.metal = material.metal * base_color(scene, i, u, v);
  if (primitive.metallic_roughness_texture >= 0 && (varies || material.coat.exists())) {
    const Vec2f texel = roughness_metalness(scene, i, u, v);
    if (varies) result.metal *= texel.y;
    result.roughness = material.roughness_factor * texel.x;
    metalness *= texel.y;
  }
  if (!material.coat.exists()) return result;
  result.coat = material.coat.normal * (1.0f - metalness);
  result.coat_grazing = material.coat.grazing * (1.0f - metalness);
  result.coat_ior = material.coat.ior;
  return result;
}

float fresnel_rise(float ior, float cosine) {
  const float c = std::clamp(cosine, 0.0f, 1.0f);
  if (ior <= 0) {
    const float s = 1.0f - c, s2 = s * s;
    return s2 * s2 * s;
  }
  const float n2 = ior * ior, inner = std::sqrt(std::max(0.0f, n2 - 1.0f + c * c));
  const float s = (c - inner) / (c + inner), p = (n2 * c - inner) / (n2 * c + inner);
  const float r = (ior - 1.0f) / (ior + 1.0f), least = r * r;
  return std::clamp((0.5f * (s * s + p * p) - least) / (1.0f - least), 0.0f, 1.0f);
}

}  // namespace patchlight
