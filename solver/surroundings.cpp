#include "solver/surroundings.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"

namespace patchlight {

namespace {

constexpr float kLeast = 0.05f;         // of a part's size: distances below count as this
constexpr float kLift = 1e-3f;          // of a part's size: how far above it its corners look for each other
constexpr float kInset = 0.02f;         // and how far inside its borders
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

bool is_exposed(const RayScene& ray_scene, const SurfacePoint& point, float offset, std::uint64_t random) {
  RayPacket packet;
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane) set_lane(ray_scene, point, offset, lane, random, packet);
  ray_scene.intersect(packet, false);
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    if (const SurfaceHit hit = ray_scene.hit(packet, lane); hit.front || hit.primitive < 0) return true;
  return false;
}

float exposed_part(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, std::uint64_t random) {
  constexpr int kPoints = 256;
  const PatchSampler sampler(scene.primitives[patch.primitive], patch);
  int exposed = 0;
  for (int k = 0; k < kPoints; ++k) {
    const Vec2f at = kronecker2(std::uint64_t(k), random);
    exposed += is_exposed(ray_scene, sampler(at.x, at.y), ray_scene.offset(patch.primitive), scramble(random + k));
  }
  return exposed == 0 ? 1.0f : std::max(float(exposed) / float(kPoints), kLeastExposed);
}

}  // namespace

float closeness(const PatchSet& scene, const RayScene& ray_scene, const Patch& part, std::uint64_t random) {
  const PatchSampler sampler(scene.primitives[part.primitive], part);
  const float size = float(std::sqrt(part.area));
  RayPacket packet;
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const Vec2f at = kronecker2(std::uint64_t(lane), random);
    set_lane(ray_scene, sampler(at.x, at.y), ray_scene.offset(part.primitive), lane, random, packet);
  }
  ray_scene.intersect(packet, false);
  float sum = 0;
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    if (const SurfaceHit hit = ray_scene.hit(packet, lane); hit.front) sum += size / std::max(hit.t, kLeast * size);
  return sum / float(RayPacket::kSize);
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

std::vector<float> exposed_parts(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed,
                                 std::int64_t& cast) {
  constexpr int kBlock = 256;
  const int count = int(scene.patches.size());
  std::vector<float> parts(count, 1.0f);
  std::vector<std::int64_t> rays((count + kBlock - 1) / kBlock);
  tbb::parallel_for(0, int(rays.size()), [&](int block) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
    for (int i = block * kBlock; i < std::min((block + 1) * kBlock, count); ++i) {
      rays[block] += 6;
      if (!is_cut(scene, ray_scene, scene.patches[i])) continue;
      parts[i] = exposed_part(scene, ray_scene, scene.patches[i], scramble(seed + std::uint64_t(i)));
      rays[block] += 256 * RayPacket::kSize;
    }
  });
  for (const std::int64_t more : rays) cast += more;
  return parts;
}

}  // namespace patchlight
