#pragma once
#include <algorithm>
#include <optional>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/sampling/sobol.h"
#include "solver/form_factors/ray_rows.h"
#include "solver/form_factors/visible_density.h"

namespace patchlight {

/// Rays of a sample set.
struct RayRows::Tables {
  explicit Tables(int rays) : all(rays), few(std::max(16, rays / kFewer / 16 * 16)) {}

  const DirectionTable& of(const RayRows& rows, std::int32_t row) const {
    const bool is_few =
        rows.ray_factors_.empty() ? is_small(rows.scene_, rows.receivers_[row]) : rows.ray_factors_[row] == kQuarter;
    return is_few ? few : all;
  }

  /// Whether a patch is small in all directions: the noise of slivers would show as streaks.
  static bool is_small(const PatchSet& scene, const Patch& patch) {
    const Primitive& p = scene.primitives[patch.primitive];
    if (patch.area <= 0 || p.shape != Primitive::Shape::quad || patch.facets > 0) return false;
    const auto at = [&](float u, float v) { return position_at(p.corners, double(u), double(v)); };
    const double longest = std::max((at(patch.u1, patch.v1) - at(patch.u0, patch.v0)).length2(),
                                    (at(patch.u0, patch.v1) - at(patch.u1, patch.v0)).length2());
    return longest < kSmall * p.patch_area;
  }

  static constexpr double kSmall = 1.0 / 64;  // squared extent of a small patch over the target area of its scale
  static constexpr int kFewer = 4;
  DirectionTable all, few;
};

/// Buffers of a row's sample sets, reused from row to row.
struct RayRows::Scratch {
  std::array<std::vector<std::int32_t>, 2> columns;
  std::array<std::vector<TransportRows::Mirrored>, 2> mirrored;
};

/// One sample set of a row while it is cast.
struct RayRows::SampleSet {
  SampleSet(const RayRows& rows, std::int32_t row_index, int sample_set, Scratch& scratch)
      : row(row_index),
        index(sample_set),
        random(hash64(rows.seed_ ^ hash64(2 * std::uint64_t(row_index) + std::uint64_t(sample_set)))),
        patch(rows.receivers_[row_index]),
        primitive(rows.scene_.primitives[patch.primitive]),
        offset(rows.ray_scene_.offset(patch.primitive)),
        columns(scratch.columns[sample_set]),
        mirrored(scratch.mirrored[sample_set]) {
    columns.clear();
    mirrored.clear();
    for (int k = 0; k < 4; ++k) digital_shift[k] = std::uint32_t((k < 2 ? random : hash64(random)) >> 32 * (k % 2));
    has_mask = has_alpha_mask(rows.scene_, patch);
    if (primitive.shape != Primitive::Shape::quad || has_mask || !patch.triangles.empty() || patch.facets > 0) {
      sampler.emplace(rows.scene_.primitives, patch);
      return;
    }
    quad = make_quad_patch(rows.ray_scene_, primitive, patch, offset);
  }

  std::int32_t row;
  int index;  ///< 0 or 1.
  std::uint64_t random;
  std::array<std::uint32_t, 4> digital_shift;  ///< Of the whole sequence.
  const Patch& patch;
  const Primitive& primitive;
  float offset;
  std::optional<PatchSampler> sampler;  ///< Of what is not a whole cell of a quad, and with alpha masks.
  bool has_mask = false;
  QuadPatch quad{};

  int block = 0;                                   ///< Block of the sequence that is being cast.
  std::array<std::uint32_t, 4> shift;              ///< Of this block, with the digital shift.
  std::int32_t cast = 0, back_hits = 0;            ///< Numbers of cast rays and of hits on unlit backs.
  std::vector<std::int32_t>& columns;              ///< Elements that rays hit.
  std::vector<Vec2f> sky;                          ///< Where rays found the environment: see SkyGuide.
  std::vector<TransportRows::Mirrored>& mirrored;  ///< Weighted as single rays.

  const VisibleDensity* density = nullptr;  ///< Of the rays' starts; null: uniform.

  /// Forgets all rays.
  void restart() {
    cast = back_hits = 0;
    columns.clear();
    sky.clear();
    mirrored.clear();
  }

  /// Casts this block of the sequence from now on.
  void begin(const DirectionTable& table, int of_block) {
    block = of_block;
    shift = table.block(std::uint32_t(block));
    for (int k = 0; k < 4; ++k) shift[k] ^= digital_shift[k];
  }

  /// The direction of a ray of the block as the arguments of cosine_direction.
  Vec2f direction_sample(const DirectionTable& table, int ray) const {
    return {unit_float(table.x[ray] ^ shift[0]), unit_float(table.y[ray] ^ shift[1])};
  }

  std::uint64_t sample_number(int ray) const { return std::uint64_t(block) << 32 | std::uint64_t(ray); }

  /// Random bits for what a ray meets after `bounce` reflections.
  std::uint64_t ray_random(int ray, int bounce) const {
    return hash64(random ^ hash64(sample_number(ray) << 8 | std::uint64_t(bounce)));
  }
};

/// Rays of a packet that go on.
struct RayRows::Reflections {
  std::array<Color, RayPacket::kSize> throughput;
  std::uint32_t started = 0;  ///< Bit of each lane that already starts from a coat.

  Reflections() { throughput.fill(Color(1.0f)); }
};

/// What a row's sample sets found of the environment.
struct RayRows::SkyRow {
  Vec3f position, normal;
  std::vector<std::int32_t> neighbours;     ///< Rows that see alike, by their distance from the first row of all.
  std::array<std::vector<Vec2f>, 2> found;  ///< One for each column of the environment.
  std::array<std::vector<Vec2f>, 2> known;  ///< Of these and of what guided rays found, some.
  std::array<std::int32_t, 2> cast{};       ///< Numbers of rays.
  std::int64_t learning_rays = 0;
  std::optional<VisibleDensity> density;  ///< Of the rays' starts; empty: uniform.

  /// Whether a sample set found it by less than a quarter of its rays: then the other set is guided.
  bool is_rare(int sample_set) const { return 4 * std::int64_t(found[sample_set].size()) < cast[sample_set]; }
};

/// Results for consecutive rows, in order of rows and sample sets.
struct RayRows::RowBlock {
  std::int32_t first = 0, last = 0;  ///< Rows [first, last).
  std::vector<std::int32_t> columns, hits;
  std::vector<float> hit_weights, visible_fractions;
  std::vector<std::int32_t> sky_columns, sky_hits;
  std::vector<float> sky_weights;
  std::vector<TransportRows::Mirrored> mirrored;
  std::vector<SkyRow> sky;  ///< [rows] Empty without an environment.
  std::int64_t rays = 0;
};

}  // namespace patchlight
