#pragma once
#include <cstdint>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/ray_scene.h"

namespace patchlight {

/// How much room a patch, or a part of one, has: its size (the root of its area) over the harmonic mean of the
/// distances that 16 of its rays go (Ward, Rubinstein and Clear 1988); and whether any of them ends on an unlit back.
struct Closeness {
  float value = 0.0f;
  bool to_backs = false;
};
Closeness closeness(const PatchSet& scene, const RayScene& ray_scene, const Patch& part, std::uint64_t random);

/// Whether any two corners of a plane patch do not see each other along it.
bool is_cut(const PatchSet& scene, const RayScene& ray_scene, const Patch& part);

/// Of a place's rays, the part that ends where light may come from or go to: on lit surfaces, or, if no unlit back is
/// in sight, nowhere. (Beside a back, nowhere is mostly below a floor or outside a room.)
float exposure(const RayScene& ray_scene, std::int32_t primitive, const SurfacePoint& point, std::uint64_t random);

/// The part of a patch that is exposed: seen from where light is, and not under or behind something that stands there
/// with its unlit back to it. What others see of a patch is its exposed part; so its own mean must be over that alone,
/// or what is covered would darken the rest. A place is the more exposed, the less of its rays end on unlit backs. At
/// least a quarter, since less cannot be told well; 1 for what is not exposed at all.
/// By `rays`, a multiple of 16; fewer than the least do not tell it well.
constexpr int kLeastForExposedPart = 1024;
float exposed_part(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays,
                   std::uint64_t random);

}  // namespace patchlight
