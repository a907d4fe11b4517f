#pragma once
#include <cstdint>

#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

constexpr int kMostMirrors = 256;  ///< On one ray's way.

/// Sends a lane's ray on from the metal that it has met, by what it reflects and by Russian roulette; `random` chooses.
/// False: it ends there.
bool go_on(const PatchSet& scene, const RayScene& ray_scene, const SurfaceHit& hit, std::uint64_t random, int lane,
           RayPacket& packet, Color& throughput);

}  // namespace patchlight
