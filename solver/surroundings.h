#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/optics/ray_scene.h"

namespace patchlight {

/// How much room a patch, or a part of one, has: its size (the root of its area) over the harmonic mean of the
/// distances that 16 of its rays go (Ward, Rubinstein and Clear 1988).
float closeness(const PatchSet& scene, const RayScene& ray_scene, const Patch& part, std::uint64_t random);

/// Whether any two corners of a plane patch do not see each other along it.
bool is_cut(const PatchSet& scene, const RayScene& ray_scene, const Patch& part);

/// The parts of patches that are exposed to light: not under something that stands on them, where all that a point sees
/// is the unlit backs of surfaces. The radiosity of a patch is that of its exposed part. Never less than a
/// quarter, and 1 for what is not exposed at all. Shape: [patches].
///
/// The same for any number of threads. Adds the number of rays to `cast`.
std::vector<float> exposed_parts(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed,
                                 std::int64_t& cast);

}  // namespace patchlight
