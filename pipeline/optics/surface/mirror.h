#pragma once
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

/// A metal of lower roughness is a perfect mirror.
constexpr float kMirrorRoughness = 0.05f;

/// Reflects `direction` (unit vector, towards the surface) by a metal, and multiplies `throughput` by the reflected
/// fraction. For a rough metal, the point `at` of the unit square selects one of the visible normals of its GGX
/// distribution (alpha = roughness^2; Heitz 2018, JCGT 7-4). Returns false if nothing is reflected.
bool reflect(const MetalProperties& metal, const Vec3f& normal, const Vec2f& at, Vec3f& direction, Color& throughput);

/// The GGX lobe of a rough metal, per sr.
struct MetalLobe {
  float value = 0.0f;    ///< BRDF times the outgoing cosine, for a specular reflectance of 1.
  float density = 0.0f;  ///< Probability density with which reflect() samples the direction.
};

/// For reflection from `in`, towards the surface, to `out`; unit vectors. Zero below the surface.
MetalLobe metal_lobe(float roughness, const Vec3f& normal, const Vec3f& in, const Vec3f& out);

}  // namespace patchlight
