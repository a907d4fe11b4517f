#include "solver/surroundings.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"

namespace patchlight {

namespace {

constexpr float kLeast = 0.05f;         // of a part's size: distances below count as this
constexpr float kLift = 1e-3f;          // of a part's size: how far above it its corners look for each other
constexpr float kInset = 0.02f;         // and how far inside its borders
constexpr float kOpen = 0.75f;          // of the most exposed place: from there on, all of a place counts
constexpr float kLeastExposed = 0.25f;  // part of a patch: the less there is, the noisier

/// A ray of a point, lane k of 16 that are stratified over the hemisphere.
void set_lane(const RayScene& ray_scene, const SurfacePoint& point, float offset, int k, std::uint64_t random,
              RayPacket& packet) {
  const float x = shifted((float(k) + 0.5f) / float(RayPacket::kSize), to_unit(random << 24));
  const Vec3f d = cosine_direction(x, shifted(radical_inverse(std::uint32_t(k)), to_unit(random)));
  Vec3f tangent, bitangent;
  orthonormal_frame(point.normal, tangent, bitangent);
  packet.set(k, ray_scene.to_local(point.position) + point.normal * offset,
             tangent * d.x + bitangent * d.y + point.normal * d.z);
}

}  // namespace

float exposure(const RayScene& ray_scene, std::int32_t primitive, const SurfacePoint& point, std::uint64_t random) {
  RayPacket packet;
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    set_lane(ray_scene, point, ray_scene.offset(primitive), lane, random, packet);
  ray_scene.intersect(packet, false);
  int lit = 0, backs = 0;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const SurfaceHit hit = ray_scene.hit(packet, lane);
    lit += hit.front;
    backs += !hit.front && hit.primitive >= 0;
  }
  return backs > 0 ? float(lit) / float(RayPacket::kSize) : 1.0f;
}

Closeness closeness(const PatchSet& scene, const RayScene& ray_scene, const Patch& part, std::uint64_t random) {
  const PatchSampler sampler(scene.primitives[part.primitive], part);
  const float size = float(std::sqrt(part.area));
  RayPacket packet;
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const Vec2f at = kronecker2(std::uint64_t(lane), random);
    set_lane(ray_scene, sampler(at.x, at.y), ray_scene.offset(part.primitive), lane, random, packet);
  }
  ray_scene.intersect(packet, false);
  Closeness result;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const SurfaceHit hit = ray_scene.hit(packet, lane);
    if (hit.primitive < 0) continue;
    result.value += size / std::max(hit.t, kLeast * size) / float(RayPacket::kSize);
    result.to_backs = result.to_backs || !hit.front;
  }
  return result;
}

bool is_cut(const PatchSet& scene, const RayScene& ray_scene, const Patch& part) {
  const Primitive& primitive = scene.primitives[part.primitive];
  if (primitive.shape != Primitive::Shape::quad) return false;
  const float u_inset = kInset * (part.u1 - part.u0), v_inset = kInset * (part.v1 - part.v0);
  const float lift = ray_scene.offset(part.primitive) + kLift * float(std::sqrt(part.area));
  std::array<Vec3f, 4> corners;
  for (int k = 0; k < 4; ++k) {
    const float u = k % 2 ? part.u1 - u_inset : part.u0 + u_inset, v = k / 2 ? part.v1 - v_inset : part.v0 + v_inset;
    corners[k] = ray_scene.to_local(point_at(primitive, u, v).position) + part.normal * lift;
  }
  RayPacket packet;
  packet.clear();
  int lane = 0;
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) {
      const Vec3f across = corners[b] - corners[a];
      const float distance = across.length();
      if (distance > 0) packet.set_shadow(lane++, corners[a], across / distance, distance);
    }
  return ray_scene.occluded(packet) != 0;
}

float exposed_part(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays,
                   std::uint64_t random) {
  const auto point_of = [](int lane) { return (lane ^ lane >> 2) & 3; };
  const PatchSampler sampler(scene.primitives[patch.primitive], patch);
  const float offset = ray_scene.offset(patch.primitive);
  std::vector<float> points;  // each with four rays that go all ways
  for (int first = 0; first < rays / 4; first += 4) {
    const std::uint64_t own = scramble(random + std::uint64_t(first));
    RayPacket packet;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const Vec2f at = kronecker2(std::uint64_t(first + point_of(lane)), random);
      set_lane(ray_scene, sampler(at.x, at.y), offset, lane, own, packet);
    }
    ray_scene.intersect(packet, false);
    std::array<int, 4> lit{}, backs{};
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene.hit(packet, lane);
      lit[point_of(lane)] += hit.front;
      backs[point_of(lane)] += !hit.front && hit.primitive >= 0;
    }
    for (int k = 0; k < 4; ++k) points.push_back(backs[k] > 0 ? 0.25f * float(lit[k]) : 1.0f);
  }
  const float most = *std::max_element(points.begin(), points.end());
  if (most == 0) return 1.0f;
  float sum = 0;
  for (const float exposed : points) sum += std::min(1.0f, exposed / (kOpen * most));
  return std::max(kLeastExposed, sum / float(points.size()));
}

}  // namespace patchlight
