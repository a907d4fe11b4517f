#include "solver/direct_factors.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"

namespace patchlight {

namespace {

constexpr int kBlock = 64;  // rows that a thread samples at a time

/// Samples of each half of a row to begin with, and more where visibility is partial. Many emitters share what would be
/// spent on four.
struct Samples {
  int pilot, partial;

  Samples(int rays, std::size_t emitters) {
    const double share = std::min(1.0, 4.0 / double(emitters));
    pilot = std::max(emitters > 4 ? 2 : 4, int(share * rays / 16));
    partial = std::max(8, int(share * rays / 2));
  }
};

}  // namespace

/// What the samples of half a row say so far.
struct DirectFactors::Sums {
  int count = 0;
  int visible = 0;
  int hidden = 0;       ///< Neither for what lies behind the emitter or below the horizon.
  double seen = 0.0;    ///< Weights of what is visible.
  double missed = 0.0;  ///< Weights of what is hidden.

  double from_seen() const { return seen / count; }
  double from_hidden(double whole) const { return whole - missed / count; }
};

Transport::Emitter DirectFactors::sample(const Emitter& emitter, std::size_t emitters, int rays,
                                         std::int64_t& cast) const {
  const auto count = std::int32_t(scene_.patches.size());
  const Samples samples(rays, emitters);
  const DirectLight light(scene_, ray_scene_, emitter);
  std::vector<Sums> sums(2 * std::size_t(count));
  const auto for_each_row = [&](auto act) {
    tbb::parallel_for(0, (count + kBlock - 1) / kBlock, [&](int block) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      for (std::int32_t row = block * kBlock; row < std::min((block + 1) * kBlock, count); ++row) act(row);
    });
    Progress::check_interrupted();
  };
  const auto owned = [&](std::int32_t row) {
    return row >= emitter.first_patch && row < emitter.first_patch + emitter.patches;
  };
  for_each_row([&](std::int32_t row) {
    if (owned(row)) return;
    for (int half = 0; half < 2; ++half) add_samples(light, row, half, 0, samples.pilot, sums[2 * row + half]);
  });

  Transport::Emitter result{emitter.first_patch, emitter.patches, std::vector<float>(sums.size(), 0.0f)};
  std::vector<Sums> more(sums.size());
  for_each_row([&](std::int32_t row) {
    if (owned(row)) return;
    const double whole = mean_form_factor(light, row);
    int visible = 0, hidden = 0;
    for (const std::int32_t near : neighbours(row))
      for (int half = 0; half < 2; ++half) {
        visible += sums[2 * near + half].visible;
        hidden += sums[2 * near + half].hidden;
      }
    for (int half = 0; half < 2; ++half) {
      const Sums& other = sums[2 * row + 1 - half];
      const int all_visible = visible + other.visible, all_hidden = hidden + other.hidden;
      Sums& own = more[2 * row + half];
      if (all_visible > 0 && all_hidden > 0) add_samples(light, row, half, 1, samples.partial, own);
      const Sums& best = own.count > 0 ? own : sums[2 * row + half];
      const double value = all_visible >= all_hidden ? best.from_hidden(whole) : best.from_seen();
      result.factors[2 * row + half] = float(value);
    }
  });
  for (const auto* all : {&sums, &more})
    for (const Sums& s : *all) cast += s.visible + s.hidden;
  return result;
}

void DirectFactors::add_samples(const DirectLight& light, std::int32_t row, int half, int round, int total,
                                Sums& sums) const {
  const Patch& patch = scene_.patches[row];
  const Primitive& primitive = scene_.primitives[patch.primitive];
  const PatchSampler sampler(primitive, patch);
  const float offset = ray_scene_.offset(patch.primitive);
  const std::uint64_t random = scramble(seed_ ^ scramble(4 * std::uint64_t(row) + 2 * half + round));
  RayPacket packet;
  std::array<float, RayPacket::kSize> weights{};
  int lanes = 0;
  const auto flush = [&] {
    if (lanes == 0) return;
    for (int lane = lanes; lane < RayPacket::kSize; ++lane) packet.valid[lane] = 0;
    const std::uint32_t blocked = ray_scene_.occluded(packet);
    for (int lane = 0; lane < lanes; ++lane) {
      const bool seen = !(blocked >> lane & 1u);
      ++(seen ? sums.visible : sums.hidden);
      (seen ? sums.seen : sums.missed) += weights[lane];
    }
    lanes = 0;
  };
  for (int k = 0; k < total; ++k) {
    const Vec2f at = kronecker2(std::uint64_t(k), random);
    const Vec2f to(shifted((float(k) + 0.5f) / float(total), to_unit(scramble(random + 1))),
                   shifted(radical_inverse(std::uint32_t(k)), to_unit(scramble(random + 2))));
    const SurfacePoint point = sampler(at.x, at.y);
    const Vec3d start = point.position + Vec3d(point.normal) * double(offset);
    const DirectLight::Sample sample = light.sample(start, point.normal, to.x, to.y);
    ++sums.count;
    if (sample.weight <= 0) continue;
    packet.set_shadow(lanes, ray_scene_.to_local(start), sample.direction, sample.distance);
    weights[lanes++] = sample.weight;
    if (lanes == RayPacket::kSize) flush();
  }
  flush();
}

/// Over a patch, by Gauss and Legendre's rule of 4 x 4 points.
double DirectFactors::mean_form_factor(const DirectLight& light, std::int32_t row) const {
  constexpr std::array<float, 4> at{0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f};
  constexpr std::array<double, 4> weight{0.1739274226, 0.3260725774, 0.3260725774, 0.1739274226};
  const Patch& patch = scene_.patches[row];
  const PatchSampler sampler(scene_.primitives[patch.primitive], patch);
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const SurfacePoint point = sampler(at[i], at[j]);
      sum += weight[i] * weight[j] * light.form_factor(point.position, point.normal);
    }
  return sum;
}

/// The patches about one on its primitive's grid; on a sphere, those of its ring.
std::vector<std::int32_t> DirectFactors::neighbours(std::int32_t i) const {
  std::vector<std::int32_t> near;
  const Patch& patch = scene_.patches[i];
  const int rows = lookup_.rows(patch.primitive);
  const int at = PatchLookup::cell(0.5f * (patch.v0 + patch.v1), rows);
  for (int k = std::max(0, at - 1); k <= std::min(rows - 1, at + 1); ++k) {
    const PatchLookup::Row& row = lookup_.row(patch.primitive, k);
    const int middle = PatchLookup::cell(0.5f * (patch.u0 + patch.u1), row.cells);
    for (int j = std::max(0, middle - 1); j <= std::min(row.cells - 1, middle + 1); ++j)
      if (row.first + j != i) near.push_back(row.first + j);
  }
  return near;
}

}  // namespace patchlight
