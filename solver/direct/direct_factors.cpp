#include "solver/direct/direct_factors.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/lights/shadow_rays.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {

namespace {

constexpr int kBlock = 64;                 // rows that a thread samples at a time
constexpr double kFarForSolidAngle = 1.5;  // radii of an emitter, from where on visibility varies more than its parts
constexpr double kFar = 30.0;  // of a patch's size: from there on, its middle is as good as its mean, to 1e-4

/// Samples of each half of a row to begin with, and more where visibility is partial. Many emitters share what would be
/// spent on four.
struct Samples {
  int pilot, partial;

  Samples(int rays, std::size_t emitters) {
    const double share = std::min(1.0, 4.0 / double(emitters));
    pilot = std::max(emitters > 4 ? 2 : 4, int(share * rays / 32));
    partial = std::max(4, int(share * rays / 2));
  }
};

}  // namespace

/// All rows of form factors to one emitter.
class DirectFactors::Run {
 public:
  Run(const DirectFactors& from, const Emitter& emitter, Samples samples)
      : from_(from),
        emitter_(emitter),
        light_(from.scene_, from.ray_scene_, emitter),
        samples_(samples),
        rows_(std::int32_t(from.receivers_.size())),
        whole_(rows_),
        pilots_(2 * std::size_t(rows_)),
        more_(2 * std::size_t(rows_)) {}

  std::vector<float> factors() {
    for_each_row([&](std::int32_t row, ShadowRays& rays) {
      if (owned(row) || is_behind(row)) return;
      whole_[row] = float(mean_form_factor(row));
      const PatchSampler sampler = sampler_of(row);
      for (int sample_set = 0; sample_set < 2; ++sample_set)
        add_samples(row, sample_set, 0, sampler, samples_.pilot, pilots_[2 * row + sample_set], rays);
    });
    const double typical = typical_of_partial();
    for_each_row([&](std::int32_t row, ShadowRays& rays) {
      if (pilots_[2 * row].count == 0) return;
      const std::array<bool, 2> partial{others(row, 0).partial(), others(row, 1).partial()};
      if (!partial[0] && !partial[1]) return;
      // In proportion to what there is to lose (Neyman 1934).
      const double share = typical > 0 ? std::clamp(whole_[row] / typical, 0.125, 4.0) : 1.0;
      const int total = std::max(4, int(share * samples_.partial));
      const PatchSampler sampler = sampler_of(row);
      for (int sample_set = 0; sample_set < 2; ++sample_set)
        if (partial[sample_set]) add_samples(row, sample_set, 1, sampler, total, more_[2 * row + sample_set], rays);
    });
    std::vector<float> values(2 * std::size_t(rows_), 0.0f);
    for (std::int32_t row = 0; row < rows_; ++row)
      for (int sample_set = 0; sample_set < 2 && !owned(row); ++sample_set) {
        const std::size_t k = 2 * std::size_t(row) + sample_set;
        const LightSamples& best = more_[k].count > 0 ? more_[k] : pilots_[k];
        if (best.count == 0) continue;
        values[k] = float(others(row, sample_set).mostly_seen() ? best.from_hidden(whole_[row]) : best.from_seen());
      }
    return values;
  }

  std::int64_t rays() const {
    std::int64_t count = 0;
    for (const auto* all : {&pilots_, &more_})
      for (const LightSamples& s : *all) count += s.visible + s.hidden;
    return count;
  }

 private:
  template <class Act>
  void for_each_row(Act act) {
    tbb::parallel_for(0, (rows_ + kBlock - 1) / kBlock, [&](int block) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      ShadowRays rays(from_.ray_scene_);
      for (std::int32_t row = block * kBlock; row < std::min((block + 1) * kBlock, rows_); ++row) act(row, rays);
      rays.cast();
    });
    Progress::check_interrupted();
  }

  bool is_behind(std::int32_t row) const {
    const Patch& patch = from_.receivers_[row];
    const Primitive& primitive = from_.scene_.primitives[patch.primitive];
    if (primitive.shape != Primitive::Shape::quad) return false;
    if (!light_.is_behind(std::array{patch.center}, patch.normal)) return false;
    std::array<Vec3d, 4> corners;
    for (int k = 0; k < 4; ++k)
      corners[k] = position_at(primitive.corners, k % 2 ? patch.u1 : patch.u0, k / 2 ? patch.v1 : patch.v0);
    return light_.is_behind(corners, patch.normal);
  }

  bool owned(std::int32_t row) const { return from_.receivers_[row].primitive == emitter_.primitive; }

  /// What the pilots about a row saw, without those of one half of it.
  Visibility others(std::int32_t row, int sample_set) const {
    Visibility sum;
    sum.add(pilots_[2 * row + 1 - sample_set]);
    Near near;
    for (const std::int32_t j : std::span(near).first(from_.neighbours_(row, near))) {
      sum.add(pilots_[2 * j]);
      sum.add(pilots_[2 * j + 1]);
    }
    return sum;
  }

  double typical_of_partial() const {
    double sum = 0, count = 0;
    for (std::int32_t row = 0; row < rows_; ++row)
      if (!owned(row) && others(row, 0).partial()) {
        sum += double(whole_[row]) * whole_[row];
        ++count;
      }
    return count > 0 ? std::sqrt(sum / count) : 0.0;
  }

  PatchSampler sampler_of(std::int32_t row) const {
    const Patch& patch = from_.receivers_[row];
    return {from_.scene_.primitives[patch.primitive], patch};
  }

  void add_samples(std::int32_t row, int sample_set, int round, const PatchSampler& sampler, int total,
                   LightSamples& sums, ShadowRays& rays) const {
    const Patch& patch = from_.receivers_[row];
    const double offset = from_.ray_scene_.offset(patch.primitive);
    const bool has_holes = has_alpha_mask(from_.scene_, patch);
    const std::uint64_t random = hash64(from_.seed_ ^ hash64(4 * std::uint64_t(row) + 2 * sample_set + round));
    const float shift_x = uniform01(hash64(random + 1)), shift_y = uniform01(hash64(random + 2));
    for (int k = 0; k < total; ++k) {
      Vec2f at = kronecker2(std::uint64_t(k), random);
      if (has_holes) at = covered_point(from_.scene_, patch, sampler, at, hash64(random + 3) + std::uint64_t(k));
      const Vec2f to(shifted((float(k) + 0.5f) / float(total), shift_x),
                     shifted(radical_inverse(std::uint32_t(k)), shift_y));
      const SurfacePoint point = sampler(at.x, at.y);
      const Vec3d start = point.position + Vec3d(point.normal) * offset;
      const DirectLight::Sample sample = light_.view(start, point.normal, kFarForSolidAngle).sample(to.x, to.y);
      ++sums.count;
      if (sample.weight > 0) rays.add(start, sample, sums);
    }
  }

  /// Over a patch, by Gauss and Legendre's rule: of a point where the emitter is far, else of 2 x 2 points, and of 4 x
  /// 4 where it is near.
  double mean_form_factor(std::int32_t row) const {
    constexpr std::array<float, 2> kTwo{0.2113248654f, 0.7886751346f};
    constexpr std::array<float, 4> kFour{0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f};
    constexpr std::array<double, 2> kTwoWeights{0.5, 0.5};
    constexpr std::array<double, 4> kFourWeights{0.1739274226, 0.3260725774, 0.3260725774, 0.1739274226};
    const Patch& patch = from_.receivers_[row];
    if (light_.distance(patch.center) > kFar * std::sqrt(patch.area))
      return light_.form_factor(patch.center, patch.normal);
    const PatchSampler sampler = sampler_of(row);
    const auto integrate = [&](const auto& places, const auto& weights) {
      double sum = 0;
      for (std::size_t j = 0; j < places.size(); ++j)
        for (std::size_t i = 0; i < places.size(); ++i) {
          const SurfacePoint point = sampler(places[i], places[j]);
          sum += weights[i] * weights[j] * light_.form_factor(point.position, point.normal);
        }
      return sum;
    };
    return light_.distance(patch.center) < 5 * std::sqrt(patch.area) ? integrate(kFour, kFourWeights)
                                                                     : integrate(kTwo, kTwoWeights);
  }

  const DirectFactors& from_;
  const Emitter& emitter_;
  const DirectLight light_;
  const Samples samples_;
  const std::int32_t rows_;
  std::vector<float> whole_;  ///< Form factors if nothing hid the emitter.
  std::vector<LightSamples> pilots_, more_;
};

Transport::Emitter DirectFactors::sample(const Emitter& emitter, std::size_t emitters, int rays,
                                         std::int64_t& cast) const {
  Run run(*this, emitter, Samples(rays, emitters));
  Transport::Emitter result{emitter.first_patch, emitter.patches, run.factors(), {}};
  cast += run.rays();
  return result;
}

DirectFactors::Neighbours grid_neighbours(const PatchSet& scene, const PatchLookup& lookup) {
  return [&](std::int32_t i, DirectFactors::Near& near) {
    const Patch& patch = scene.patches[i];
    const int rows = lookup.rows(patch.primitive);
    const int at = PatchLookup::cell(0.5f * (patch.v0 + patch.v1), rows);
    int count = 0;
    for (int k = std::max(0, at - 1); k <= std::min(rows - 1, at + 1); ++k) {
      const PatchLookup::Row& row = lookup.row(patch.primitive, k);
      const int middle = PatchLookup::cell(0.5f * (patch.u0 + patch.u1), row.cells);
      for (int j = std::max(0, middle - 1); j <= std::min(row.cells - 1, middle + 1); ++j)
        if (row.first + j != i) near[count++] = row.first + j;
    }
    return count;
  };
}

}  // namespace patchlight
