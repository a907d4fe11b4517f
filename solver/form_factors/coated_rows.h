#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Whether rays of rows that hit a primitive reach its diffuse part by chance, or else are reflected or let through.
/// Rays that hit other coated or transparent surfaces, which also emit or are partly metallic, both end there and go
/// on.
inline bool passes_by_chance(const PatchSet& scene, const Primitive& primitive) {
  const Material& material = scene.materials[primitive.material];
  return (material.is_coated() || material.transmission.exists()) && material.specular == Color(0.0f) &&
         primitive.light_group < 0;
}

/// What remains for the diffuse part of what passes a primitive's coat.
inline float untransmitted_part(const PatchSet& scene, const Primitive& primitive) {
  return 1.0f - scene.materials[primitive.material].transmission.part;
}

/// Whether the scene has metals, over which rows and photons bring the light of sampled emitters.
bool has_metals(const PatchSet& scene);

}  // namespace patchlight
