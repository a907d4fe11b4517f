#include "solver/exposed_part.h"

#include <algorithm>
#include <array>
#include <vector>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"
#include "solver/surroundings.h"

namespace patchlight {

namespace {

constexpr float kOpen = 0.75f;          // of the most exposed place: from there on, all of a place counts
constexpr float kLeastExposed = 0.25f;  // part of a patch: the less there is, the noisier

}  // namespace

float exposed_part(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays, std::uint64_t random,
                   std::int64_t& cast) {
  const auto point_of = [](int lane) { return (lane ^ lane >> 2) & 3; };
  const PatchSampler sampler(scene.primitives[patch.primitive], patch);
  const float offset = ray_scene.offset(patch.primitive);
  std::vector<float> points;  // each with four rays that go all ways
  float most = 0;
  for (int first = 0; first < rays / 4; first += 4) {
    const StratifiedDirections directions(scramble(random + std::uint64_t(first)));
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const Vec2f at = kronecker2(std::uint64_t(first + point_of(lane)), random);
      directions.set(lane, ray_scene, sampler(at.x, at.y), offset, packet);
    }
    ray_scene.intersect(packet, false);
    cast += RayPacket::kSize;
    std::array<int, 4> lit{}, backs{};
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene.hit(packet, lane);
      lit[point_of(lane)] += hit.front;
      backs[point_of(lane)] += !hit.front && hit.primitive >= 0;
    }
    for (int k = 0; k < 4; ++k) {
      const float open = points.emplace_back(backs[k] > 0 ? 0.25f * float(lit[k]) : 1.0f);
      most = std::max(most, open);
    }
  }
  if (most == 0) return 1.0f;
  float sum = 0;
  for (const float exposed : points) sum += std::min(1.0f, exposed / (kOpen * most));
  return std::max(kLeastExposed, sum / float(points.size()));
}

}  // namespace patchlight
