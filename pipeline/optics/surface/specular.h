#pragma once
#include <algorithm>

#include "pipeline/model/patch_set.h"

namespace patchlight {

inline float max_component(const Color& c) {
  return std::max({c.x, c.y, c.z});
}

/// Specular reflection at a surface point: that of metal and of a coat, which have the same roughness.
struct SpecularProperties {
  Color metal{0.0f};  ///< Reflectance, each in [0,1].
  float roughness = 1.0f;
  Color coat{0.0f};  ///< Reflectance of the coat at normal incidence; 0: no coat.
  float coat_grazing = 0.0f;
  float coat_ior = 0.0f;
  ClearCoat clear_coat{};  ///< Over both.

  bool has_coat() const { return coat != Color(0.0f); }
  bool is_black() const { return metal == Color(0.0f) && !has_coat() && !clear_coat.exists(); }
  /// Reflectance of metal and coat, for the cosine of the angle to a mirroring facet.
  Color reflectance(float cosine) const;
  /// The clear coat alone, as a coat; and what is below it.
  SpecularProperties clear_layer() const;
  SpecularProperties below() const;
};

/// Specular reflection at (u,v) of primitive `i`: the material's, varied by textures and vertex colours.
SpecularProperties specular_properties_at(const PatchSet& scene, std::int32_t i, double u, double v);

/// Shape of the Fresnel reflectance of a coat: 0 at normal incidence (cosine 1), 1 at grazing incidence. Exact for a
/// dielectric of index `ior`; Schlick's for 0.
float fresnel_rise(float ior, float cosine);

}  // namespace patchlight
