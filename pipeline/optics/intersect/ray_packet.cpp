#include "pipeline/optics/intersect/ray_packet.h"

#include <limits>

namespace patchlight {

namespace {

// Part of a shadow ray's length by which it ends before its end, where a surface may be: the tracers round distances by
// 10 u, and directions and the given distance are rounded by u each.
constexpr float kShadowEnd = 0x1p-20f;

/// Makes a lane a ray without end and without a hit.
inline void activate(RayPacket& packet, int lane, float t_near) {
  auto& r = packet.rays.ray;
  r.tnear[lane] = t_near;
  r.tfar[lane] = std::numeric_limits<float>::infinity();
  r.time[lane] = 0.0f;
  r.mask[lane] = ~0u;
  r.id[lane] = 0;
  r.flags[lane] = 0;
  packet.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  packet.rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  packet.valid[lane] = -1;
}

}  // namespace

void RayPacket::clear() {
  valid.fill(0);
}

void RayPacket::start() {
  for (int lane = 0; lane < kSize; ++lane) activate(*this, lane, 0.0f);
}

void RayPacket::set(int lane, const Vec3f& origin, const Vec3f& direction, float t_near) {
  auto& r = rays.ray;
  r.org_x[lane] = origin.x;
  r.org_y[lane] = origin.y;
  r.org_z[lane] = origin.z;
  r.dir_x[lane] = direction.x;
  r.dir_y[lane] = direction.y;
  r.dir_z[lane] = direction.z;
  activate(*this, lane, t_near);
}

void RayPacket::set_shadow(int lane, const Vec3f& origin, const Vec3f& direction, float distance) {
  set(lane, origin, direction);
  rays.ray.tfar[lane] = distance * (1.0f - kShadowEnd);
}

void RayPacket::copy_lane(const RayPacket& from, int lane) {
  const std::uint32_t bit = 1u << lane;
  valid[lane] = from.valid[lane];
  passable = (passable & ~bit) | (from.passable & bit);
  const auto copy = [lane](auto& to, const auto& other) { to[lane] = other[lane]; };
  auto& r = rays.ray;
  const auto& s = from.rays.ray;
  copy(r.org_x, s.org_x), copy(r.org_y, s.org_y), copy(r.org_z, s.org_z);
  copy(r.dir_x, s.dir_x), copy(r.dir_y, s.dir_y), copy(r.dir_z, s.dir_z);
  copy(r.tnear, s.tnear), copy(r.tfar, s.tfar);
  copy(rays.hit.u, from.rays.hit.u), copy(rays.hit.v, from.rays.hit.v);
  copy(rays.hit.primID, from.rays.hit.primID), copy(rays.hit.geomID, from.rays.hit.geomID);
}

}  // namespace patchlight
