#include "solver/direct/direct_factors.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/lights/shadow_rays.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/sampling/sobol.h"
#include "solver/direct/mean_form_factor.h"

namespace patchlight {

namespace {

constexpr int kRowsPerTask = 64;
constexpr int kClusterPilots = 8;

/// Samples of each sample set: of the pilot pass, and where visibility is partial. More than four emitters share the
/// samples that four would take.
struct SampleCounts {
  int pilot, partial;

  SampleCounts(int rays, std::size_t emitters) {
    const double share = std::min(1.0, 4.0 / double(emitters));
    pilot = std::max(emitters > 4 ? 2 : 4, int(share * rays / 32));
    partial = std::max(4, int(share * rays));
  }
};

}  // namespace

/// Samples the form factors of all receivers to one emitter.
class DirectFactors::EmitterSampler {
 public:
  EmitterSampler(const DirectFactors& parent, const Emitter& emitter, const PlaneMirror* mirror, SampleCounts counts)
      : parent_(parent),
        mirror_(mirror),
        dark_(mirror ? mirror->primitive() : emitter.primitive),
        light_(light_of(parent, emitter, mirror)),
        counts_(counts),
        rows_(std::int32_t(parent.receivers_.size())),
        unoccluded_(rows_),
        pilots_(2 * std::size_t(rows_)),
        refined_(2 * std::size_t(rows_)) {}

  void cast() {
    for_each_row([&](std::int32_t row, ShadowRays& rays) {
      if (is_dark(row) || cannot_illuminate(row)) return;
      const PatchSampler sampler = patch_sampler(row);
      unoccluded_[row] =
          float(mean_form_factor(light_, parent_.receivers_[row], sampler, parent_.densities_.find(row)));
      for (int sample_set = 0; sample_set < 2; ++sample_set)
        add_samples(row, sample_set, 0, sampler, pilot_samples(row), pilots_[2 * row + sample_set], rays);
    });
    const double rms = rms_of_partially_visible();
    for_each_row([&](std::int32_t row, ShadowRays& rays) {
      if (pilots_[2 * row].count == 0) return;
      const std::array<bool, 2> partial{nearby_visibility(row, 0).partial(), nearby_visibility(row, 1).partial()};
      if (!partial[0] && !partial[1]) return;
      // Sample counts proportional to the standard deviation (Neyman 1934).
      const double scale = rms > 0 ? std::clamp(unoccluded_[row] / rms, 0.125, 4.0) : 1.0;
      const int total = std::max(4, int(std::bit_floor(unsigned(1.4142 * scale * counts_.partial))));
      const PatchSampler sampler = patch_sampler(row);
      for (int sample_set = 0; sample_set < 2; ++sample_set)
        if (partial[sample_set]) add_samples(row, sample_set, 1, sampler, total, refined_[2 * row + sample_set], rays);
    });
  }

  std::vector<float> factors() const {
    std::vector<float> values(2 * std::size_t(rows_), 0.0f);
    for (std::int32_t row = 0; row < rows_; ++row)
      for (int sample_set = 0; sample_set < 2 && !is_dark(row); ++sample_set) {
        const std::size_t k = 2 * std::size_t(row) + sample_set;
        const LightSamples& samples = samples_of(k);
        if (samples.count == 0) continue;
        const double value = nearby_visibility(row, sample_set).mostly_visible()
                                 ? samples.estimate_from_hidden(unoccluded_[row])
                                 : samples.estimate_from_visible();
        values[k] = float(std::max(value, 0.0));  // by noise, what is hidden may exceed the whole
      }
    return values;
  }

  /// See Transport::Emitter::tints.
  std::vector<Color> tints() const {
    std::vector<Color> values(2 * std::size_t(rows_));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = samples_of(k).tint();
    const auto is_white = [](const Color& tint) { return tint == Color(1.0f); };
    return std::ranges::all_of(values, is_white) ? std::vector<Color>{} : values;
  }

  std::int64_t rays() const {
    std::int64_t count = 0;
    for (const auto* samples : {&pilots_, &refined_})
      for (const LightSamples& s : *samples) count += s.visible + s.hidden;
    return count;
  }

 private:
  const LightSamples& samples_of(std::size_t k) const { return refined_[k].count > 0 ? refined_[k] : pilots_[k]; }

  static DirectLight light_of(const DirectFactors& parent, const Emitter& emitter, const PlaneMirror* mirror) {
    const DirectLight light(parent.scene_, parent.ray_scene_, emitter);
    return mirror ? light.image(*mirror) : light;
  }

  template <class Act>
  void for_each_row(Act act) {
    tbb::parallel_for(0, (rows_ + kRowsPerTask - 1) / kRowsPerTask, [&](int block) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
      ShadowRays rays(parent_.ray_scene_, mirror_);
      for (std::int32_t row = block * kRowsPerTask; row < std::min((block + 1) * kRowsPerTask, rows_); ++row)
        act(row, rays);
      rays.cast();
    });
    Progress::check_interrupted();
  }

  bool cannot_illuminate(std::int32_t row) const {
    const Patch& patch = parent_.receivers_[row];
    const Primitive& primitive = parent_.scene_.primitives[patch.primitive];
    if (primitive.shape != Primitive::Shape::quad || patch.facets > 0) return false;
    if (!mirror_ && !light_.cannot_illuminate(std::array{patch.center}, patch.normal)) return false;
    std::array<Vec3d, 4> corners;
    for (int k = 0; k < 4; ++k)
      corners[k] = position_at(primitive.corners, k % 2 ? patch.u1 : patch.u0, k / 2 ? patch.v1 : patch.v0);
    return light_.cannot_illuminate(corners, patch.normal) || (mirror_ && mirror_->is_behind(corners));
  }

  /// More of a cluster, of which only some facets may face the light.
  int pilot_samples(std::int32_t row) const {
    return parent_.receivers_[row].facets > 0 ? kClusterPilots * counts_.pilot : counts_.pilot;
  }

  bool is_dark(std::int32_t row) const { return parent_.receivers_[row].primitive == dark_; }

  /// Visibility that the pilot samples near a row found, without those of the given sample set.
  Visibility nearby_visibility(std::int32_t row, int sample_set) const {
    Visibility sum;
    sum.add(pilots_[2 * row + 1 - sample_set]);
    NeighbourList list;
    for (const std::int32_t j : std::span(list).first(parent_.find_neighbours_(row, list))) {
      sum.add(pilots_[2 * j]);
      sum.add(pilots_[2 * j + 1]);
    }
    return sum;
  }

  /// Root mean square of the unoccluded form factors of partly visible rows.
  double rms_of_partially_visible() const {
    double sum = 0, count = 0;
    for (std::int32_t row = 0; row < rows_; ++row)
      if (!is_dark(row) && nearby_visibility(row, 0).partial()) {
        sum += double(unoccluded_[row]) * unoccluded_[row];
        ++count;
      }
    return count > 0 ? std::sqrt(sum / count) : 0.0;
  }

  PatchSampler patch_sampler(std::int32_t row) const {
    const Patch& patch = parent_.receivers_[row];
    return {parent_.scene_.primitives, patch};
  }

  void add_samples(std::int32_t row, int sample_set, int round, const PatchSampler& sampler, int total,
                   LightSamples& sums, ShadowRays& rays) const {
    const Patch& patch = parent_.receivers_[row];
    const double offset = parent_.ray_scene_.offset(patch.primitive);
    const bool has_mask = has_alpha_mask(parent_.scene_, patch);
    const VisibleDensity* density = parent_.densities_.find(row);
    const std::uint64_t random = hash64(parent_.seed_ ^ hash64(4 * std::uint64_t(row) + 2 * sample_set + round));
    const PointPairs pairs(random);
    for (int k = 0; k < total; ++k) {
      auto [at, to] = pairs(std::uint32_t(k));
      if (density) at = (*density)(at);
      if (has_mask) at = covered_point(parent_.scene_, patch, sampler, at, hash64(random + 2) + std::uint64_t(k));
      const SurfacePoint point = sampler(at.x, at.y);
      const Vec3d start = point.position + Vec3d(point.normal) * offset;
      const DirectLight::Sample sample = light_.view(start, point.normal, kAreaSamplingDistance).sample(to.x, to.y);
      ++sums.count;
      if (sample.weight > 0) rays.add(start, sample, to, sums);
    }
  }

  const DirectFactors& parent_;
  const PlaneMirror* const mirror_;  ///< Null: direct light.
  const std::int32_t dark_;          ///< The primitive whose own points get no light: the emitter, or the mirror.
  const DirectLight light_;          ///< The emitter, or its virtual image.
  const SampleCounts counts_;
  const std::int32_t rows_;
  std::vector<float> unoccluded_;               ///< [rows] Unoccluded form factors.
  std::vector<LightSamples> pilots_, refined_;  ///< [2 rows]: [row][sample set].
};

Transport::Emitter DirectFactors::sample(const Emitter& emitter, std::size_t emitters, int rays,
                                         std::int64_t& cast) const {
  EmitterSampler sampler(*this, emitter, nullptr, SampleCounts(rays, emitters));
  sampler.cast();
  Transport::Emitter result{emitter.first_patch, emitter.patches, sampler.factors(), {}};
  result.tints = sampler.tints();
  cast += sampler.rays();
  return result;
}

std::vector<Color> DirectFactors::sample_image(const Emitter& emitter, const PlaneMirror& mirror, std::size_t images,
                                               int rays, std::int64_t& cast) const {
  EmitterSampler sampler(*this, emitter, &mirror, SampleCounts(rays, images));
  sampler.cast();
  const std::vector<float> factors = sampler.factors();
  std::vector<Color> tints = sampler.tints();
  tints.resize(factors.size(), Color(1.0f));
  for (std::size_t k = 0; k < factors.size(); ++k) tints[k] *= factors[k];
  cast += sampler.rays();
  return tints;
}

DirectFactors::FindNeighbours grid_neighbours(const PatchSet& scene, const PatchLookup& lookup,
                                              const Lattices& lattices, bool also_behind) {
  return [&scene, &lookup, &lattices, also_behind](std::int32_t i, DirectFactors::NeighbourList& neighbours) {
    const Patch& patch = scene.patches[i];
    const bool sphere = scene.primitives[patch.primitive].shape == Primitive::Shape::sphere;
    const bool all = also_behind || sphere;
    const int rows = lookup.rows(patch.primitive);
    const int at = PatchLookup::cell(0.5f * (patch.v0 + patch.v1), rows);
    int count = 0;
    for (int k = std::max(0, at - 1); k <= std::min(rows - 1, at + 1); ++k) {
      const PatchLookup::Row& row = lookup.row(patch.primitive, k);
      const int middle = PatchLookup::cell(0.5f * (patch.u0 + patch.u1), row.cells);
      for (int j = std::max(0, middle - 1); j <= std::min(row.cells - 1, middle + 1); ++j)
        if (const std::int32_t next = lookup.at(row, j);
            next >= 0 && next != i && (all || lookup.is_open(patch.primitive, std::min(j, middle), std::min(k, at))))
          neighbours[count++] = next;
    }
    if (sphere || lattices.empty()) return count;
    const int columns = lookup.row(patch.primitive, 0).cells;
    const int column = PatchLookup::cell(0.5f * (patch.u0 + patch.u1), columns);
    for (int k = at - 1; k <= at + 1; ++k)
      for (int j = column - 1; j <= column + 1; ++j)
        if (k < 0 || k >= rows || j < 0 || j >= columns)
          if (const std::int32_t beyond = lattices.beyond(patch.primitive, j, k); beyond >= 0)
            neighbours[count++] = beyond;
    return count;
  };
}

}  // namespace patchlight
