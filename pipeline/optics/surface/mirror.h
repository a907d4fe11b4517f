#pragma once
#include "pipeline/optics/surface/specular.h"

namespace patchlight {

/// A metal or coat of lower roughness is a perfect mirror.
constexpr float kMirrorRoughness = 0.05f;

/// Reflects `direction` (unit vector, towards the surface) by metal and coat, and multiplies `throughput` by the
/// reflected fraction. If they are rough, the point `at` of the unit square selects one of the visible normals of their
/// GGX distribution (alpha = roughness^2; Heitz 2018, JCGT 7-4). Returns false if nothing is reflected.
bool reflect(const SpecularProperties& specular, const Vec3f& normal, const Vec2f& at, Vec3f& direction,
             Color& throughput);

/// A facet of a GGX surface of this roughness that is visible against `direction` (unit vector, towards the surface),
/// selected by the point `at` of the unit square; of a smooth one, `normal`. Unit vectors.
Vec3f visible_facet(float roughness, const Vec3f& normal, const Vec2f& at, const Vec3f& direction);

/// The GGX lobe of a rough metal or coat, per sr.
struct SpecularLobe {
  float value = 0.0f;    ///< BRDF times the outgoing cosine, for a reflectance of 1.
  float density = 0.0f;  ///< Probability density with which reflect() samples the direction.
};

/// For reflection from `in`, towards the surface, to `out`; unit vectors. Zero below the surface.
SpecularLobe specular_lobe(float roughness, const Vec3f& normal, const Vec3f& in, const Vec3f& out);

}  // namespace patchlight
