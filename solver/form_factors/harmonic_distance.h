#pragma once
#include <array>
#include <cstdint>

#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

/// How much room a patch, or a part of one, has: its size (the root of its area) over the harmonic mean of the
/// distances that 16 of its rays go (Ward, Rubinstein and Clear 1988); and whether any of them ends on an unlit back.
struct RefinementCriterion {
  float value = 0.0f;
  bool to_backs = false;
};
RefinementCriterion refinement_criterion(const PatchSet& scene, const RayScene& ray_scene, const Patch& part,
                                         std::uint64_t random);

/// Whether any two corners of a plane patch do not see each other along it.
bool is_cut(const PatchSet& scene, const RayScene& ray_scene, const Patch& part);

/// Of a place's rays, the part that ends where light may come from or go to: on lit surfaces, or, if no unlit back is
/// in sight, nowhere. (Beside a back, nowhere is mostly below a floor or outside a room.)
float lit_ray_fraction(const RayScene& ray_scene, std::int32_t primitive, const SurfacePoint& point,
                       std::uint64_t random);

/// Sets a lane to go from `offset` above a point of a surface, along a direction about +Z that is turned to the normal.
void leave_surface(int lane, const RayScene& ray_scene, const SurfacePoint& point, float offset, const Vec3f& about_z,
                   RayPacket& packet);

}  // namespace patchlight
