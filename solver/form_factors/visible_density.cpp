#include "solver/form_factors/visible_density.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
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

}  // namespace

VisibleDensity::VisibleDensity(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch,
                               std::uint64_t random)
    : random_(random), probability_(kCells * kCells, 1.0f / float(kCells * kCells)) {
  row_probability_.fill(1.0f / kCells);
  if (scene.primitives[patch.primitive].mask >= 0) return;
  const PatchSampler sampler(scene.primitives[patch.primitive], patch);
  const float offset = ray_scene.offset(patch.primitive);
  constexpr int kPoints = RayPacket::kSize / 2, kBlocks = kCells / kBlock;
  std::vector<Hits> cells(kCells * kCells), blocks(kBlocks * kBlocks);
  for (int first = 0; first < kCells * kCells; first += kPoints) {
    const std::uint64_t packet_random = hash64(random + std::uint64_t(first));
    const auto directions = stratified_directions(packet_random);
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const int k = first + lane % kPoints;
      const Vec2f at = point(k);
      leave_surface(lane, ray_scene, sampler(at.x, at.y), offset, directions[lane], packet);
    }
    ray_scene.intersect(packet, false);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene.hit(packet, lane);
      const int k = first + lane % kPoints;
      for (Hits* hits : {&cells[k], &blocks[k / kCells / kBlock * kBlocks + k % kCells / kBlock]})
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
    probability_[k] = 0.5f * float(visible);
    sum += probability_[k];
    squares += visible == 2 ? 1.0f : 0.0f;
  }
  if (sum < kMinOpen * float(kCells * kCells) || squares == 0) {
    std::fill(probability_.begin(), probability_.end(), 1.0f / float(kCells * kCells));
    return;
  }
  visible_fraction_ = std::min(1.0f, sum * sum / (squares * float(kCells * kCells)));
  for (float& p : probability_) p /= sum;
  for (int y = 0; y < kCells; ++y) {
    row_probability_[y] = 0;
    for (int x = 0; x < kCells; ++x) row_probability_[y] += probability_[y * kCells + x];
  }
}

Vec2f VisibleDensity::point(int cell) const {
  const Vec2f at = kronecker2(std::uint64_t(cell), random_);
  return {(float(cell % kCells) + at.x) / kCells, (float(cell / kCells) + at.y) / kCells};
}

Vec2f VisibleDensity::operator()(const Vec2f& at) const {
  const auto invert = [](const float* probabilities, float total, float x) {
    float rest = x * total;
    int k = 0;
    while (k + 1 < kCells && (rest >= probabilities[k] || probabilities[k] <= 0)) rest -= probabilities[k++];
    return std::pair(k, probabilities[k] > 0 ? std::clamp(rest / probabilities[k], 0.0f, 1.0f) : 0.5f);
  };
  constexpr float kReach = 0.25f / kCells;  // about a point, so that starts beside a visible point are visible too
  const auto [row, y] = invert(row_probability_.data(), 1.0f, at.y);
  const auto [column, x] = invert(probability_.data() + row * kCells, row_probability_[row], at.x);
  const Vec2f around = point(row * kCells + column) + Vec2f(x - 0.5f, y - 0.5f) * kReach;
  return {std::clamp(around.x, 0.0f, 1.0f), std::clamp(around.y, 0.0f, 1.0f)};
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
