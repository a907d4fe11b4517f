#include "solver/form_factors/visible_density.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

namespace {

constexpr float kMinOpen = 1.0f / 64;  // mean openness below which the density is uniform: too noisy
constexpr float kMaxGaps = 0.05f;      // part of the rays inside of a closed room that may hit nothing
constexpr int kBlock = 4;              // cells along a side of a block that is judged as a whole

/// What rays hit: a lit surface or the environment, an unlit back, or nothing.
struct Hits {
  int lit = 0, nothing = 0, backs = 0;
};

constexpr int kBlocks = VisibleDensity::kCells / kBlock;

/// Index of the cell of a block.
int cell_of(int block, int lane) {
  const int x = block % kBlocks * kBlock + lane % kBlock, y = block / kBlocks * kBlock + lane / kBlock;
  return y * VisibleDensity::kCells + x;
}

/// Directions about +Z with the density cos / pi, two for each cell. Those of a block are alike, which is faster: they
/// lie in one of 4 x 4 parts of the hemisphere.
std::vector<Vec3f> ray_directions() {
  std::vector<Vec3f> directions(VisibleDensity::kRays);
  for (int block = 0; block < kBlocks * kBlocks; ++block)
    for (int round = 0; round < 2; ++round)
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const int k = 2 * cell_of(block, lane) + round, part = (5 * block + 8 * round) % 16;
        const Vec2f inside = kronecker2(std::uint64_t(k), 0);
        directions[k] = cosine_direction((float(part % 4) + inside.x) / 4, (float(part / 4) + inside.y) / 4);
      }
  return directions;
}

}  // namespace

VisibleDensity::VisibleDensity(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch,
                               std::uint64_t random)
    : random_(random), cell_sums_(kCells * kCells, 1.0f) {
  if (scene.primitives[patch.primitive].mask >= 0) {
    accumulate();
    return;
  }
  const PatchSampler sampler(scene.primitives, patch);
  const float offset = ray_scene.offset(patch.primitive);
  static const std::vector<Vec3f> kDirections = ray_directions();
  std::vector<Hits> cells(kCells * kCells), blocks(kBlocks * kBlocks);
  for (int block = 0; block < kBlocks * kBlocks; ++block)
    for (int round = 0; round < 2; ++round) {
      RayPacket packet;
      packet.clear();
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const int k = cell_of(block, lane);
        const Vec2f at = point(k);
        leave_surface(lane, ray_scene, sampler(at.x, at.y), offset, kDirections[2 * k + round], packet);
      }
      ray_scene.intersect(packet, true);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const SurfaceHit hit = ray_scene.hit(packet, lane);
        for (Hits* hits : {&cells[cell_of(block, lane)], &blocks[block]})
          ++(hit.front || (hit.primitive < 0 && scene.environment) ? hits->lit
             : hit.primitive >= 0                                  ? hits->backs
                                                                   : hits->nothing);
      }
    }
  Hits inside;  // from blocks that see lit surfaces and no backs
  for (const Hits& block : blocks)
    if (block.backs == 0 && block.lit > 0) inside.lit += block.lit, inside.nothing += block.nothing;
  const bool open = float(inside.nothing) > kMaxGaps * float(inside.lit + inside.nothing);
  float sum = 0, squares = 0;  // of V and V^2
  for (int k = 0; k < kCells * kCells; ++k) {
    const int visible = cells[k].lit + (open ? cells[k].nothing : 0);
    cell_sums_[k] = 0.5f * float(visible);
    sum += cell_sums_[k];
    squares += visible == 2 ? 1.0f : 0.0f;
  }
  if (sum < kMinOpen * float(kCells * kCells) || squares == 0) {
    std::fill(cell_sums_.begin(), cell_sums_.end(), 1.0f);
    accumulate();
    return;
  }
  visible_fraction_ = std::min(1.0f, sum * sum / (squares * float(kCells * kCells)));
  accumulate();
}

/// Turns relative probabilities into sums: of each row's first cells, and of the first rows.
void VisibleDensity::accumulate() {
  for (int y = 0; y < kCells; ++y) {
    const auto row = cell_sums_.begin() + y * kCells;
    std::partial_sum(row, row + kCells, row);
    row_sums_[y] = row[kCells - 1] + (y > 0 ? row_sums_[y - 1] : 0.0f);
  }
}

Vec2f VisibleDensity::point(int cell) const {
  const Vec2f at = kronecker2(std::uint64_t(cell), random_);
  return {(float(cell % kCells) + at.x) / kCells, (float(cell / kCells) + at.y) / kCells};
}

Vec2f VisibleDensity::operator()(const Vec2f& at) const {
  const auto invert = [](const float* sums, float x) {
    const float sum = x * sums[kCells - 1];
    const auto k = int(std::upper_bound(sums, sums + kCells - 1, sum) - sums);
    const float below = k > 0 ? sums[k - 1] : 0.0f, width = sums[k] - below;
    return std::pair(k, width > 0 ? std::clamp((sum - below) / width, 0.0f, 1.0f) : 0.5f);
  };
  constexpr float kReach = 0.001f / kCells;  // starts lie beside visible points; farther off they may be covered
  const auto [row, y] = invert(row_sums_.data(), at.y);
  const auto [column, x] = invert(cell_sums_.data() + row * kCells, at.x);
  const Vec2f around = point(row * kCells + column) + Vec2f(x - 0.5f, y - 0.5f) * kReach;
  // Mirrored at the border, since a start on it may lie outside of the scene.
  const auto inside = [](float u) { return u < 0.0f ? -u : u > 1.0f ? 2.0f - u : u; };
  return {inside(around.x), inside(around.y)};
}

VisibleDensities::VisibleDensities(const PatchSet& scene, const RayScene& ray_scene,
                                   const std::vector<float>& visible_fractions, std::uint64_t seed) {
  std::vector<std::int32_t> patches;
  for (std::size_t i = 0; 2 * i < visible_fractions.size(); ++i)
    if (visible_fractions[2 * i] < 1.0f) patches.push_back(std::int32_t(i));
  std::vector<std::optional<VisibleDensity>> all(patches.size());
  tbb::parallel_for(std::size_t(0), patches.size(), [&](std::size_t k) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    all[k].emplace(scene, ray_scene, scene.patches[patches[k]], visible_density_random(seed, patches[k]));
  });
  for (std::size_t k = 0; k < patches.size(); ++k) densities_.emplace(patches[k], *all[k]);
}

std::uint64_t visible_density_random(std::uint64_t seed, std::int32_t patch) {
  return hash64(hash64(seed) ^ hash64(~std::uint64_t(patch)));
}

}  // namespace patchlight
