#pragma once
#include <cstdint>

#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/surface/specular.h"

namespace patchlight {

constexpr int kMaxMirrorBounces = 256;  ///< Largest number of mirror reflections of a ray.

/// Russian roulette for faint rays; false if the ray ends.
bool survives_roulette(std::uint64_t random, Color& throughput);

/// Whether a clear coat reflects a ray in `direction` that hits it, by chance, as a facet of it does that the ray
/// meets: then `direction` is reflected. `random`: seed.
bool reflects_at_clear_coat(const SpecularProperties& specular, const Vec3f& normal, std::uint64_t random,
                            Vec3f& direction);

/// Reflects a lane's ray at the metal or coat that it hit, with Russian roulette; `random` seeds both. Multiplies
/// `throughput` by the reflected fraction. Returns false if the ray ends.
bool continue_at_mirror(const PatchSet& scene, const RayScene& ray_scene, const SurfaceHit& hit, std::uint64_t random,
                        int lane, RayPacket& packet, Color& throughput);

}  // namespace patchlight
