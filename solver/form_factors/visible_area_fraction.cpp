#include "solver/form_factors/visible_area_fraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

namespace {

constexpr float kFullyOpen = 0.75f;  // openness, relative to the most open point, from which a point counts fully
constexpr float kMinOpen = 0.5f;     // openness of the most open point below which the whole patch is covered
constexpr float kMinVisibleFraction = 0.25f;  // smaller fractions are too noisy

using Directions = std::array<Vec3f, RayPacket::kSize>;

/// Directions about +Z with the density cos / pi, one in each stratum of four rings and four quarters: direction k is
/// in ring k / 4 and quarter k % 4.
Directions stratified_directions(std::uint64_t random) {
  const float inside = uniform01(random << 24), turn = float(kPi / 2) * uniform01(random);
  const float cosine = std::cos(turn), sine = std::sin(turn);
  Directions directions;
  for (int k = 0; k < RayPacket::kSize; k += 4) {
    const float square = (float(k / 4) + inside) / 4, radius = std::sqrt(square), z = std::sqrt(1.0f - square);
    const float x = radius * cosine, y = radius * sine;
    directions[k] = {x, y, z};
    directions[k + 1] = {-y, x, z};
    directions[k + 2] = {-x, -y, z};
    directions[k + 3] = {y, -x, z};
  }
  return directions;
}

}  // namespace

float visible_area_fraction(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays,
                            std::uint64_t random, std::int64_t& cast) {
  const PatchSampler sampler(scene.primitives[patch.primitive], patch);
  const float offset = ray_scene.offset(patch.primitive);
  std::vector<float> open(std::size_t(rays) /
                          4);  // openness of each point, by four rays in different rings and quarters
  std::vector<std::uint8_t> backs(open.size(), 0);
  const int sets = rays / RayPacket::kSize;
  for (int first = 0; first < sets; first += RayPacket::kSize) {
    const int count = std::min(RayPacket::kSize, sets - first);
    std::array<Directions, RayPacket::kSize> directions;
    for (int lane = 0; lane < count; ++lane)
      directions[lane] = stratified_directions(hash64(random + std::uint64_t(first + lane)));
    for (int k = 0; k < RayPacket::kSize; ++k) {  // coherent rays, from points of all sets
      const int point_of_set = (k ^ k >> 2) & 3;
      const auto point = [&](int lane) { return std::size_t(4 * (first + lane) + point_of_set); };
      RayPacket packet;
      packet.clear();
      for (int lane = 0; lane < count; ++lane) {
        const Vec2f at = kronecker2(point(lane), random);
        leave_surface(lane, ray_scene, sampler(at.x, at.y), offset, directions[lane][k], packet);
      }
      ray_scene.intersect(packet, true);
      for (int lane = 0; lane < count; ++lane) {
        const SurfaceHit hit = ray_scene.hit(packet, lane);
        open[point(lane)] += 0.25f * float(hit.front);
        backs[point(lane)] |= !hit.front && hit.primitive >= 0;
      }
    }
  }
  cast += rays;
  for (std::size_t k = 0; k < open.size(); ++k)
    if (backs[k] == 0) open[k] = 1.0f;
  const float max_open = *std::max_element(open.begin(), open.end());
  if (max_open < kMinOpen) return 1.0f;
  float sum = 0;
  for (const float openness : open) sum += std::min(1.0f, openness / (kFullyOpen * max_open));
  return std::max(kMinVisibleFraction, sum / float(open.size()));
}

}  // namespace patchlight
