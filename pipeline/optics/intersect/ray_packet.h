#pragma once
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>

#include "pipeline/model/math.h"

namespace patchlight {

/// Sixteen rays in the RayScene's local frame, and their hits.
struct alignas(64) RayPacket {
  static constexpr int kSize = 16;

  RTCRayHit16 rays;
  alignas(64) std::array<int, kSize> valid{};  ///< -1: active lane; 0: inactive.
  std::uint32_t passable = 0;  ///< Bit of each lane whose closest hit lets light pass; set by intersect().

  /// Activates all lanes as rays without end; the caller sets origins and directions.
  void start();
  /// Deactivates all lanes.
  void clear();
  /// Activates a lane as a ray from `origin` along `direction` (any length), starting at t = `t_near`.
  void set(int lane, const Vec3f& origin, const Vec3f& direction, float t_near = 0.0f);
  /// Activates a lane as a shadow ray for occluded(), which ends at t = `distance`, less its rounding.
  void set_shadow(int lane, const Vec3f& origin, const Vec3f& direction, float distance);
  /// Takes over a lane and its hit from another packet.
  void copy_lane(const RayPacket& from, int lane);
  Vec3f origin(int lane) const { return {rays.ray.org_x[lane], rays.ray.org_y[lane], rays.ray.org_z[lane]}; }
  Vec3f direction(int lane) const { return {rays.ray.dir_x[lane], rays.ray.dir_y[lane], rays.ray.dir_z[lane]}; }
};

}  // namespace patchlight
