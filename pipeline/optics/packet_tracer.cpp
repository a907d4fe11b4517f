#include "pipeline/optics/packet_tracer.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/vector_code.h"

namespace patchlight {

namespace {

constexpr int kLanes = 16;
constexpr int kDeepest = 48;
constexpr float kSteep = 1e30f;  // stands for the inverse of zero, so that nothing is not a number

}  // namespace

/// Rays, and what they have met so far.
struct alignas(64) PacketTracer::Packet {
  std::array<std::array<float, kLanes>, 3> origin, direction, inverse;
  std::array<float, kLanes> near, far, s, t;
  std::array<std::int32_t, kLanes> surface;

  explicit Packet(const RTCRay16& r) {
    const float* const o[] = {r.org_x, r.org_y, r.org_z};
    const float* const d[] = {r.dir_x, r.dir_y, r.dir_z};
    for (int k = 0; k < 3; ++k) {
      std::copy_n(o[k], kLanes, origin[k].data());
      std::copy_n(d[k], kLanes, direction[k].data());
      for (int lane = 0; lane < kLanes; ++lane)
        inverse[k][lane] = std::abs(d[k][lane]) > 1 / kSteep ? 1 / d[k][lane] : kSteep;
    }
    std::copy_n(r.tnear, kLanes, near.data());
    std::copy_n(r.tfar, kLanes, far.data());
    surface.fill(-1);
  }
};

VECTOR_CODE bool PacketTracer::reaches(const Packet& p, const Node& node) {
  int any = 0;
  const Node n = node;
  for (int lane = 0; lane < kLanes; ++lane) {
    float enter = p.near[lane], leave = p.far[lane];
    for (int k = 0; k < 3; ++k) {
      const float a = (n.low[k] - p.origin[k][lane]) * p.inverse[k][lane];
      const float b = (n.high[k] - p.origin[k][lane]) * p.inverse[k][lane];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    any |= enter <= leave;
  }
  return any;
}

VECTOR_CODE void PacketTracer::meet(const Facet& facet, std::int32_t surface, Packet& p) {
  const Facet f = facet;
  for (int lane = 0; lane < kLanes; ++lane) {
    const float dx = p.direction[0][lane], dy = p.direction[1][lane], dz = p.direction[2][lane];
    const float x = p.origin[0][lane] - f.corner[0], y = p.origin[1][lane] - f.corner[1];
    const float z = p.origin[2][lane] - f.corner[2];
    const float distance = -(x * f.normal[0] + y * f.normal[1] + z * f.normal[2]) /
                           (dx * f.normal[0] + dy * f.normal[1] + dz * f.normal[2]);
    const float px = x + distance * dx, py = y + distance * dy, pz = z + distance * dz;
    const float s = px * f.s[0] + py * f.s[1] + pz * f.s[2];
    const float t = px * f.t[0] + py * f.t[1] + pz * f.t[2];
    const float third = f.third[0] * (1.0f - s) + f.third[1] * t;
    const float fourth = f.fourth[0] * (1.0f - t) + f.fourth[1] * s;
    const bool met = (s >= f.rounding[0]) & (t >= f.rounding[1]) & (third >= f.rounding[2]) &
                     (fourth >= f.rounding[3]) & (distance > p.near[lane]) & (distance < p.far[lane]);
    p.far[lane] = met ? distance : p.far[lane];
    p.s[lane] = met ? f.start + f.sign * s : p.s[lane];
    p.t[lane] = met ? f.start + f.sign * t : p.t[lane];
    p.surface[lane] = met ? surface : p.surface[lane];
  }
}

VECTOR_CODE void PacketTracer::meet(const Ball& ball, std::int32_t surface, Packet& p) {
  const Ball b = ball;
  for (int lane = 0; lane < kLanes; ++lane) {
    const float dx = p.direction[0][lane], dy = p.direction[1][lane], dz = p.direction[2][lane];
    const float x = b.center[0] - p.origin[0][lane], y = b.center[1] - p.origin[1][lane];
    const float z = b.center[2] - p.origin[2][lane];
    const float scale = 1.0f / (dx * dx + dy * dy + dz * dz);
    const float middle = (x * dx + y * dy + z * dz) * scale;
    const float off_x = x - middle * dx, off_y = y - middle * dy, off_z = z - middle * dz;
    const float inside = b.radius * b.radius - (off_x * off_x + off_y * off_y + off_z * off_z);
    const float half = std::sqrt(std::max(inside, 0.0f) * scale);
    const float enter = middle - half, leave = middle + half;
    const float distance = enter > p.near[lane] ? enter : leave;
    const bool met = (inside >= 0.0f) & (distance > p.near[lane]) & (distance < p.far[lane]);
    p.far[lane] = met ? distance : p.far[lane];
    p.surface[lane] = met ? surface : p.surface[lane];
  }
}

/// Nodes from near to far, as the first lane goes; visit() says whether to go on.
template <class Visit>
void PacketTracer::traverse(Packet& packet, Visit visit) const {
  std::array<std::int32_t, kDeepest> stack;
  int waiting = 0;
  if (!nodes_.empty()) stack[waiting++] = 0;
  while (waiting > 0) {
    const Node& node = nodes_[stack[--waiting]];
    if (!reaches(packet, node)) continue;
    if (node.count == 0) {
      const bool backwards = packet.direction[node.axis][0] < 0;
      stack[waiting++] = node.first + !backwards;
      stack[waiting++] = node.first + backwards;
      continue;
    }
    for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
      const Item& item = items_[k];
      if (item.surface % 2 == 0)
        meet(facets_[item.shape], item.surface, packet);
      else
        meet(balls_[item.shape], item.surface, packet);
    }
    if (!visit()) return;
  }
}

void PacketTracer::intersect(RTCRayHit16& rays) const {
  Packet packet(rays.ray);
  traverse(packet, [] { return true; });
  for (int lane = 0; lane < kLanes; ++lane) {
    if (packet.surface[lane] < 0) continue;
    rays.ray.tfar[lane] = packet.far[lane];
    rays.hit.u[lane] = packet.s[lane];
    rays.hit.v[lane] = packet.t[lane];
    rays.hit.primID[lane] = unsigned(packet.surface[lane]) >> 1;
    rays.hit.geomID[lane] = unsigned(packet.surface[lane]) & 1u;
  }
}

std::uint32_t PacketTracer::occluded(const RTCRay16& rays, std::uint32_t wanted) const {
  Packet packet(rays);
  std::uint32_t blocked = 0;
  traverse(packet, [&] {
    blocked = 0;
    for (int lane = 0; lane < kLanes; ++lane) blocked |= std::uint32_t(packet.surface[lane] >= 0) << lane;
    return (wanted & ~blocked) != 0;
  });
  return blocked & wanted;
}

}  // namespace patchlight
