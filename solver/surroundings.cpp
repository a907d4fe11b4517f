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

ExposedParts::Grid ExposedParts::grid_of(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch,
                                         std::uint64_t random) {
  const PatchSampler sampler(scene.primitives[patch.primitive], patch);
  Grid grid;
  float most = 0;
  for (int k = 0; k < kAcross * kAcross; ++k) {
    const Vec2f shift = kronecker2(std::uint64_t(k), random);
    const float x = (float(k % kAcross) + shift.x) / kAcross, y = (float(k / kAcross) + shift.y) / kAcross;
    grid.kept[k] = exposure(ray_scene, patch.primitive, sampler(x, y), scramble(random + k));
    most = std::max(most, grid.kept[k]);
  }
  if (most == 0) return {};
  grid.mean = 0;
  for (float& kept : grid.kept) {
    kept = std::min(1.0f, kept / (kOpen * most));
    grid.mean += kept / float(grid.kept.size());
  }
  const float lift = std::max(0.0f, (kLeastExposed - grid.mean) / (1.0f - grid.mean));
  for (float& kept : grid.kept) kept += lift * (1.0f - kept);
  grid.mean = std::max(grid.mean, kLeastExposed);
  return grid;
}

ExposedParts::ExposedParts(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed, std::int64_t& cast)
    : at_(scene.patches.size(), -1) {
  constexpr int kBlock = 256;
  const int count = int(scene.patches.size());
  std::vector<std::vector<std::array<Grid, 2>>> found((count + kBlock - 1) / kBlock);
  std::vector<std::int64_t> rays((count + kBlock - 1) / kBlock);
  tbb::parallel_for(0, int(rays.size()), [&](int block) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
    for (int i = block * kBlock; i < std::min((block + 1) * kBlock, count); ++i) {
      const Patch& patch = scene.patches[i];
      const std::uint64_t random = scramble(seed + std::uint64_t(i));
      rays[block] += RayPacket::kSize + 6;
      if (!closeness(scene, ray_scene, patch, random).to_backs && !is_cut(scene, ray_scene, patch)) continue;
      const std::array<Grid, 2> halves{grid_of(scene, ray_scene, patch, random),
                                       grid_of(scene, ray_scene, patch, scramble(random))};
      rays[block] += 2 * kAcross * kAcross * RayPacket::kSize;
      if (halves[0].mean == 1.0f && halves[1].mean == 1.0f) continue;
      at_[i] = std::int32_t(found[block].size());
      found[block].push_back(halves);
    }
  });
  for (const std::int64_t more : rays) cast += more;
  std::vector<std::size_t> first;
  for (const auto& grids : found) {
    first.push_back(grids_.size());
    grids_.insert(grids_.end(), grids.begin(), grids.end());
  }
  for (int i = 0; i < count; ++i)
    if (at_[i] >= 0) at_[i] += std::int32_t(first[i / kBlock]);
}

bool ExposedParts::keeps(std::int32_t i, int half, float x, float y, std::uint64_t random) const {
  if (at_[i] < 0) return true;
  const auto cell = [](float t) { return std::min(int(t * kAcross), kAcross - 1); };
  return to_unit(random) < grids_[at_[i]][half].kept[cell(y) * kAcross + cell(x)];
}

}  // namespace patchlight
