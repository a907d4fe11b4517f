#pragma once
#include <cstdint>

#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

constexpr int kMinRaysForVisibleFraction = 1024;  ///< Rays for an accurate estimate.

/// Visible area fraction of a patch: the part of its area that is not under or behind a surface with its unlit back to
/// the patch. Other patches see only the visible part, so the patch's mean irradiance must be over that part alone, or
/// the covered part would darken it. A point counts the less, the more of its rays hit unlit backs.
/// In [0.25,1], since smaller fractions are too noisy; 1 where at no point half of the rays are free.
/// `rays`: a multiple of 16; added to `cast`.
float visible_area_fraction(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays,
                            std::uint64_t random, std::int64_t& cast);

}  // namespace patchlight
