#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Below it a metal is a perfect mirror.
constexpr float kMirrorRoughness = 0.05f;

/// Turns `direction` (unit vector, towards the surface) into one that a metal reflects it to and multiplies
/// `throughput` by what is reflected. A rough metal takes one of the directions of its GGX lobe, chosen by `at`, a
/// point of the unit square, among the normals that the ray can see (alpha = roughness^2; Heitz 2018, JCGT 7-4). False:
/// nothing is reflected.
bool reflect(const Material& material, const Vec3f& normal, const Vec2f& at, Vec3f& direction, Color& throughput);

}  // namespace patchlight
