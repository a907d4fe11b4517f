#pragma once
#include <cstdint>

#include "pipeline/optics/ray_scene.h"

namespace patchlight {

/// The part of a patch that is exposed: seen from where light is, and not under or behind something that stands there
/// with its unlit back to it. What others see of a patch is its exposed part; so its own mean must be over that alone,
/// or what is covered would darken the rest. At least a quarter, since less cannot be told well; 1 for what is not
/// exposed at all. The number of rays that it takes is added to `cast`.
///
/// A place is exposed if at least half as many of its rays end on lit surfaces as do of the most exposed place. Places
/// on a lattice, the finer the more `rays` the patch's row has, are told apart so; between those that differ the border
/// is found by bisection, and the area within it by lines from crossing to crossing (marching squares, Lorensen and
/// Cline 1987 in the plane).
float exposed_part(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays, std::uint64_t random,
                   std::int64_t& cast);

}  // namespace patchlight
