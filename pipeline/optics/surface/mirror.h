#pragma once
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

/// Below it a metal is a perfect mirror.
constexpr float kMirrorRoughness = 0.05f;

/// Turns `direction` (unit vector, towards the surface) into one that a metal reflects it to and multiplies
/// `throughput` by what is reflected. A rough metal takes one of the directions of its GGX lobe, chosen by `at`, a
/// point of the unit square, among the normals that the ray can see (alpha = roughness^2; Heitz 2018, JCGT 7-4). False:
/// nothing is reflected.
bool reflect(const MetallicRoughness& metal, const Vec3f& normal, const Vec2f& at, Vec3f& direction, Color& throughput);

/// The GGX lobe that a rough metal reflects a ray by, per sr.
struct MetalLobe {
  float value = 0.0f;    ///< BRDF times the outgoing cosine, but for the metal's reflectance.
  float density = 0.0f;  ///< With which reflect() takes a direction.
};

/// For a ray along `in`, towards the surface, that leaves along `out`; unit vectors. Zero below the surface.
MetalLobe metal_lobe(float roughness, const Vec3f& normal, const Vec3f& in, const Vec3f& out);

}  // namespace patchlight
