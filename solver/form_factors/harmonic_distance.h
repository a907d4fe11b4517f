#pragma once
#include <array>
#include <cstdint>

#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

/// Refinement criterion of a patch or a part of one (Ward, Rubinstein and Clear 1988) from 16 rays; from 80 where none
/// of them hits anything but unlit backs.
struct RefinementCriterion {
  float value = 0.0f;       ///< Size (root of the area) over the harmonic mean distance.
  bool hits_backs = false;  ///< Whether a ray hits an unlit back.
  bool is_open = false;     ///< Whether a ray hits anything but unlit backs.
  int rays = 0;
};
RefinementCriterion refinement_criterion(const PatchSet& scene, const RayScene& ray_scene, const Patch& part,
                                         std::uint64_t random);

/// Fraction of 64 rays, which are added to `rays`, from a point that find a lit surface or the environment; 1 if none
/// of the first 16 hits an unlit back. (Where backs are visible, rays that hit nothing are mostly below a floor or
/// outside of a room.)
float lit_ray_fraction(const PatchSet& scene, const RayScene& ray_scene, std::int32_t primitive,
                       const SurfacePoint& point, std::uint64_t random, int& rays);

/// How far 32 rays, which are added to `rays`, go from a point.
struct PointDistances {
  float far = 0;            ///< Fraction of rays that hit nothing nearer than `distance`, m.
  float harmonic_mean = 0;  ///< m; infinite if none hits anything.
};
PointDistances distances_from(const RayScene& ray_scene, std::int32_t primitive, const SurfacePoint& point,
                              float distance, std::uint64_t random, int& rays);

/// Sixteen stratified directions about +Z with the density cos / pi.
std::array<Vec3f, RayPacket::kSize> stratified_directions(std::uint64_t random);

/// Sets a lane's ray: its origin `offset` above a point of a surface, its direction `about_z` in the frame of the
/// normal.
void leave_surface(int lane, const RayScene& ray_scene, const SurfacePoint& point, float offset, const Vec3f& about_z,
                   RayPacket& packet);

}  // namespace patchlight
