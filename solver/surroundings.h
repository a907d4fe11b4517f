#pragma once
#include <array>
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

/// Directions of a packet's rays from surfaces, each lane's own of 16 that are stratified over the hemisphere.
class StratifiedDirections {
 public:
  explicit StratifiedDirections(std::uint64_t random);

  /// Sets a lane to go from a point of a surface, `offset` above it.
  void set(int lane, const RayScene& ray_scene, const SurfacePoint& point, float offset, RayPacket& packet) const;

 private:
  std::array<Vec3f, RayPacket::kSize> about_z_;
};

}  // namespace patchlight
