#include "pipeline/optics/packet_tracer.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

using packet::kLanes;

constexpr float kSteep = 1e30f;  // stands for the inverse of zero, so that nothing is not a number

packet::Rays rays_of(const RTCRay16& r) {
  packet::Rays rays;
  const float* const origins[] = {r.org_x, r.org_y, r.org_z};
  const float* const directions[] = {r.dir_x, r.dir_y, r.dir_z};
  for (int k = 0; k < 3; ++k) {
    std::copy_n(origins[k], kLanes, rays.origin[k]);
    std::copy_n(directions[k], kLanes, rays.direction[k]);
    for (int lane = 0; lane < kLanes; ++lane)
      rays.inverse[k][lane] = std::abs(directions[k][lane]) > 1 / kSteep ? 1 / directions[k][lane] : kSteep;
  }
  std::copy_n(r.tnear, kLanes, rays.near);
  std::copy_n(r.tfar, kLanes, rays.far);
  std::fill_n(rays.surface, kLanes, -1);
  return rays;
}

}  // namespace

packet::Trace packet::fastest() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return trace_by_16;
  return __builtin_cpu_supports("avx2") ? trace_by_8 : trace_by_4;
}

void PacketTracer::trace(packet::Rays& rays, std::uint32_t wanted) const {
  if (!nodes_.empty()) trace_({nodes_.data(), items_.data(), facets_.data(), balls_.data()}, rays, wanted);
}

void PacketTracer::intersect(RTCRayHit16& to) const {
  packet::Rays rays = rays_of(to.ray);
  trace(rays, 0);
  for (int lane = 0; lane < kLanes; ++lane) {
    if (rays.surface[lane] < 0) continue;
    to.ray.tfar[lane] = rays.far[lane];
    to.hit.u[lane] = rays.s[lane];
    to.hit.v[lane] = rays.t[lane];
    to.hit.primID[lane] = unsigned(rays.surface[lane]) >> 1;
    to.hit.geomID[lane] = unsigned(rays.surface[lane]) & 1u;
  }
}

std::uint32_t PacketTracer::occluded(const RTCRay16& from, std::uint32_t wanted) const {
  if (wanted == 0) return 0;
  packet::Rays rays = rays_of(from);
  trace(rays, wanted);
  std::uint32_t blocked = 0;
  for (int lane = 0; lane < kLanes; ++lane) blocked |= std::uint32_t(rays.surface[lane] >= 0) << lane;
  return blocked & wanted;
}

}  // namespace patchlight
