#include "pipeline/optics/intersect/packet_tracer.h"

#include <array>
#include <limits>

namespace patchlight {

namespace {

using packet::kLanes;

// From here to minus here, nothing is met, whatever else a lane holds.
constexpr float kEndless = std::numeric_limits<float>::infinity();

packet::Rays rays_of(const RTCRay16& r, const float* near, float* far, float* s, float* t) {
  packet::Rays rays{{r.org_x, r.org_y, r.org_z}, {r.dir_x, r.dir_y, r.dir_z}, near, far, s, t, {}};
  for (std::int32_t& surface : rays.surface) surface = -1;
  return rays;
}

}  // namespace

packet::Trace packet::fastest() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return trace_by_4;
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") ? trace_by_16 : trace_by_8;
}

void PacketTracer::trace(packet::Rays& rays, std::uint32_t wanted) const {
  if (!nodes_.empty()) trace_({nodes_.data(), items_.data(), facets_.data(), balls_.data()}, rays, wanted);
}

void PacketTracer::intersect(RTCRayHit16& to, std::uint32_t wanted) const {
  for (int lane = 0; lane < kLanes; ++lane)
    if (!(wanted >> lane & 1u)) to.ray.tnear[lane] = kEndless, to.ray.tfar[lane] = -kEndless;
  packet::Rays rays = rays_of(to.ray, to.ray.tnear, to.ray.tfar, to.hit.u, to.hit.v);
  trace(rays, 0);
  for (int lane = 0; lane < kLanes; ++lane) {
    if (rays.surface[lane] < 0) continue;
    to.hit.primID[lane] = unsigned(rays.surface[lane]) >> 1;
    to.hit.geomID[lane] = unsigned(rays.surface[lane]) & 1u;
  }
}

std::uint32_t PacketTracer::occluded(const RTCRay16& from, std::uint32_t wanted) const {
  if (wanted == 0) return 0;
  alignas(64) std::array<float, kLanes> near, far, s{}, t{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool asked = wanted >> lane & 1u;
    near[lane] = asked ? from.tnear[lane] : kEndless;
    far[lane] = asked ? from.tfar[lane] : -kEndless;
  }
  packet::Rays rays = rays_of(from, near.data(), far.data(), s.data(), t.data());
  trace(rays, wanted);
  std::uint32_t blocked = 0;
  for (int lane = 0; lane < kLanes; ++lane) blocked |= std::uint32_t(rays.surface[lane] >= 0) << lane;
  return blocked & wanted;
}

}  // namespace patchlight
