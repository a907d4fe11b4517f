#include "solver/form_factors/harmonic_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {

namespace {

// Relative to the size of a patch or part.
constexpr float kMinDistance = 0.05f;  // lower bound of hit distances

}  // namespace

std::array<Vec3f, RayPacket::kSize> stratified_directions(std::uint64_t random) {
  static const std::array<Vec2f, RayPacket::kSize> kAround = [] {
    std::array<Vec2f, RayPacket::kSize> around;
    for (int k = 0; k < RayPacket::kSize; ++k) {
      const float angle = float(2 * kPi) * radical_inverse(std::uint32_t(k));
      around[k] = Vec2f(std::cos(angle), std::sin(angle));
    }
    return around;
  }();
  const float shift = uniform01(random << 24), turn = float(2 * kPi) * uniform01(random);
  const float cosine = std::cos(turn), sine = std::sin(turn);
  std::array<Vec3f, RayPacket::kSize> directions;
  for (int k = 0; k < RayPacket::kSize; ++k) {
    const float square = shifted((float(k) + 0.5f) / float(RayPacket::kSize), shift);
    const float radius = std::sqrt(square);
    directions[k] = Vec3f(radius * (kAround[k].x * cosine - kAround[k].y * sine),
                          radius * (kAround[k].x * sine + kAround[k].y * cosine), std::sqrt(1.0f - square));
  }
  return directions;
}

void leave_surface(int lane, const RayScene& ray_scene, const SurfacePoint& point, float offset, const Vec3f& about_z,
                   RayPacket& packet) {
  Vec3f tangent, bitangent;
  orthonormal_frame(point.normal, tangent, bitangent);
  packet.set(lane, ray_scene.to_local(point.position) + point.normal * offset,
             tangent * about_z.x + bitangent * about_z.y + point.normal * about_z.z);
}

float lit_ray_fraction(const PatchSet& scene, const RayScene& ray_scene, std::int32_t primitive,
                       const SurfacePoint& point, std::uint64_t random, int& rays) {
  constexpr int kPackets = 4;
  int lit = 0, backs = 0;
  for (int k = 0; k < kPackets; ++k) {
    const auto directions = stratified_directions(random);
    random = hash64(random);
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      leave_surface(lane, ray_scene, point, ray_scene.offset(primitive), directions[lane], packet);
    ray_scene.intersect(packet, false);
    rays += RayPacket::kSize;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene.hit(packet, lane);
      lit += hit.front || (hit.primitive < 0 && scene.environment);
      backs += !hit.front && hit.primitive >= 0;
    }
    if (backs == 0) return 1.0f;
  }
  return float(lit) / float(kPackets * RayPacket::kSize);
}

PointDistances distances_from(const RayScene& ray_scene, std::int32_t primitive, const SurfacePoint& point,
                              float distance, std::uint64_t random, int& rays) {
  constexpr int kPackets = 2;
  int far = 0;
  float inverse = 0;
  for (int k = 0; k < kPackets; ++k, random = hash64(random)) {
    const auto directions = stratified_directions(random);
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      leave_surface(lane, ray_scene, point, ray_scene.offset(primitive), directions[lane], packet);
    ray_scene.intersect(packet, false);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene.hit(packet, lane);
      far += hit.primitive < 0 || hit.t >= distance;
      if (hit.primitive >= 0) inverse += 1.0f / std::max(hit.t, kMinDistance * distance);
    }
  }
  constexpr int kRays = kPackets * RayPacket::kSize;
  rays += kRays;
  return {float(far) / kRays, inverse > 0 ? kRays / inverse : std::numeric_limits<float>::infinity()};
}

RefinementCriterion refinement_criterion(const PatchSet& scene, const RayScene& ray_scene, const Patch& part,
                                         std::uint64_t random) {
  constexpr int kPackets = 5;
  const PatchSampler sampler(scene.primitives, part);
  const float size = float(std::sqrt(part.area));
  RefinementCriterion result;
  for (int k = 0; k < kPackets && !result.is_open; ++k, random = hash64(random)) {
    const auto directions = stratified_directions(random);
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const Vec2f at = kronecker2(std::uint64_t(lane), random);
      leave_surface(lane, ray_scene, sampler(at.x, at.y), ray_scene.offset(part.primitive), directions[lane], packet);
    }
    ray_scene.intersect(packet, false);
    float value = 0;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene.hit(packet, lane);
      result.is_open = result.is_open || hit.front || hit.primitive < 0;
      if (hit.primitive < 0) continue;
      value += size / std::max(hit.t, kMinDistance * size) / float(RayPacket::kSize);
      result.hits_backs = result.hits_backs || !hit.front;
    }
    result.value += (value - result.value) / float(k + 1);
    result.rays += RayPacket::kSize;
  }
  return result;
}

}  // namespace patchlight
