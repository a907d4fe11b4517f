#include "pipeline/optics/intersect/packet_tracer.h"

#include <array>
#include <limits>

namespace patchlight {

namespace {

using packet::kLanes;

// A lane from +infinity to -infinity hits nothing, whatever else it holds.
constexpr float kInfinity = std::numeric_limits<float>::infinity();

packet::Rays rays_of(const RTCRay16& r, const float* near, float* far, float* s, float* t) {
  packet::Rays rays{{r.org_x, r.org_y, r.org_z}, {r.dir_x, r.dir_y, r.dir_z}, near, far, s, t, {}};
  for (std::int32_t& surface : rays.surface) surface = -1;
  return rays;
}

}  // namespace

packet::TraceFunction packet::fastest_trace() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return trace_width_4;
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") ? trace_width_16 : trace_width_8;
}

void PacketTracer::trace(packet::Rays& rays, std::uint32_t occlusion_lanes) const {
  if (!nodes_.empty())
    trace_({nodes_.data(), references_.data(), facets_.data(), spheres_.data()}, rays, occlusion_lanes);
}

void PacketTracer::intersect(RTCRayHit16& to, std::uint32_t active) const {
  for (int lane = 0; lane < kLanes; ++lane)
    if (!(active >> lane & 1u)) to.ray.tnear[lane] = kInfinity, to.ray.tfar[lane] = -kInfinity;
  packet::Rays rays = rays_of(to.ray, to.ray.tnear, to.ray.tfar, to.hit.u, to.hit.v);
  trace(rays, 0);
  for (int lane = 0; lane < kLanes; ++lane) {
    if (rays.surface[lane] < 0) continue;
    to.hit.primID[lane] = unsigned(rays.surface[lane]) >> 1;
    to.hit.geomID[lane] = unsigned(rays.surface[lane]) & 1u;
  }
}

std::uint32_t PacketTracer::occluded(const RTCRay16& from, std::uint32_t active) const {
  if (active == 0) return 0;
  alignas(64) std::array<float, kLanes> near, far, s{}, t{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool is_active = active >> lane & 1u;
    near[lane] = is_active ? from.tnear[lane] : kInfinity;
    far[lane] = is_active ? from.tfar[lane] : -kInfinity;
  }
  packet::Rays rays = rays_of(from, near.data(), far.data(), s.data(), t.data());
  trace(rays, active);
  std::uint32_t occluded_lanes = 0;
  for (int lane = 0; lane < kLanes; ++lane) occluded_lanes |= std::uint32_t(rays.surface[lane] >= 0) << lane;
  return occluded_lanes & active;
}

}  // namespace patchlight
