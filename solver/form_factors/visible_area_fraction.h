#pragma once
#include <cstdint>

#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

constexpr int kMinRaysForVisibleFraction = 1024;  ///< Rays, to tell it well.

/// The part of a patch that is exposed: seen from where light is, and not under or behind something that stands there
/// with its unlit back to it. What others see of a patch is its exposed part; so its own mean must be over that alone,
/// or what is covered would darken the rest. A place is the more exposed, the less of its rays end on unlit backs. At
/// least a quarter, since less cannot be told well; 1 where no place has half of its rays free.
/// By `rays`, a multiple of 16, which it adds to `cast`.
float visible_area_fraction(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays,
                            std::uint64_t random, std::int64_t& cast);

}  // namespace patchlight
