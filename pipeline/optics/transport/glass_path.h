#pragma once
#include <cstdint>
#include <span>

#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/surface/glass.h"

namespace patchlight {

/// What a ray does at a surface that lets light pass.
enum class Passing {
  open,       ///< It meets no surface: alpha leaves the place open.
  lands,      ///< It ends on the diffuse part.
  ends,       ///< It ends by Russian roulette, as it is faint.
  reflected,  ///< It goes on, on its side.
  passed,     ///< It goes on, on the other side.
};

inline bool goes_on(Passing passing) {
  return passing == Passing::open || passing == Passing::reflected || passing == Passing::passed;
}

/// Chooses by chance what a lane's ray does at the surface that it hit, which lets light pass, and sets the ray that
/// goes on; `random` seeds the choice. Multiplies `throughput` by what weighs the choice: 1 for a smooth surface
/// without colour. Rays inside of a body lose what it absorbs.
Passing cross_by_chance(const PatchSet& scene, const RayScene& ray_scene, const SurfaceHit& hit, std::uint64_t random,
                        int lane, RayPacket& packet, Color& throughput);

/// Moves the active lanes, whose closest hits are known, straight past surfaces that let light pass, to their next
/// hits. Multiplies the lanes' `throughput` by what passes, unless it is empty. `all`: also past what turns light.
void pass_straight(const PatchSet& scene, const RayScene& ray_scene, RayPacket& packet, std::span<Color> throughput,
                   bool all);

/// Whether a primitive is of glass that may turn light: see turns_light().
inline bool is_turning(const PatchSet& scene, std::int32_t primitive) {
  return turns_light(scene.materials[scene.primitives[primitive].material]);
}

}  // namespace patchlight
