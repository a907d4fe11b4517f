#include "solver/form_factors/ray_rows.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <optional>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/mirror_path.h"
#include "pipeline/system/prefaulted_memory.h"
#include "solver/form_factors/quad_rays.h"
#include "solver/form_factors/visible_density.h"

namespace patchlight {

namespace {

constexpr int kRowsPerTask = 16;
constexpr std::int64_t kRaysAtOnce = 1 << 18;  // between two checks for an interrupt

constexpr int kMaxSequenceBlocks = 8;  // for a row most of whose rays hit nothing
constexpr int kRaysPerBackHit = 64;    // with more hits of unlit backs, rays start with a VisibleDensity

}  // namespace

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
    const std::uint64_t shift_bits = rows.independent_ ? random : hash64(rows.seed_ ^ std::uint64_t(row_index));
    for (int k = 0; k < 4; ++k)
      digital_shift[k] = std::uint32_t((k < 2 ? shift_bits : hash64(shift_bits)) >> 32 * (k % 2));
    has_mask = has_alpha_mask(rows.scene_, patch);
    if (primitive.shape != Primitive::Shape::quad || has_mask) {
      sampler.emplace(primitive, patch);
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
  std::optional<PatchSampler> sampler;  ///< Of spheres and of patches with alpha masks.
  bool has_mask = false;
  QuadPatch quad{};

  int block = 0;                                   ///< Block of the sequence that is being cast.
  std::array<std::uint32_t, 4> shift;              ///< Of this block, with the digital shift.
  std::int32_t cast = 0, back_hits = 0;            ///< Numbers of cast rays and of hits on unlit backs.
  std::vector<std::int32_t>& columns;              ///< Elements that rays hit.
  std::vector<TransportRows::Mirrored>& mirrored;  ///< Weighted as single rays.

  const VisibleDensity* density = nullptr;  ///< Of the rays' starts; null: uniform.

  /// Forgets all rays.
  void restart() {
    cast = back_hits = 0;
    columns.clear();
    mirrored.clear();
  }

  std::uint64_t sample_number(int ray) const { return std::uint64_t(block) << 32 | std::uint64_t(ray); }
};

RayRows::RayRows(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers,
                 const Elements& elements, std::uint64_t seed, SampleSets sets, bool visible_fractions)
    : scene_(scene),
      ray_scene_(ray_scene),
      receivers_(receivers),
      elements_(elements),
      seed_(hash64(seed)),
      visible_fractions_(visible_fractions),
      independent_(sets == SampleSets::independent) {
  for (const Primitive& p : scene.primitives) {
    metallic_.push_back(scene.materials[p.material].specular != Color(0.0f));
    has_metals_ = has_metals_ || metallic_.back();
  }
}

std::int64_t RayRows::cast(int rays, TransportRows& rows, Progress& progress, Shard shard) const {
  const auto start = std::int32_t(shard.first(receivers_.size())), end = std::int32_t(shard.last(receivers_.size()));
  const std::int32_t count = end - start;
  const int set_rays = std::max(16, (rays + 31) / 32 * 16);
  const DirectionTable table(set_rays);
  rows = {};
  rows.rays = 2 * set_rays;
  rows.starts.push_back(0);
  rows.columns.reserve(std::size_t(count) * std::size_t(rows.rays));
  const int tasks = (count + kRowsPerTask - 1) / kRowsPerTask;
  const int tasks_at_once = std::max(1, int(kRaysAtOnce / (2 * set_rays * kRowsPerTask)));
  std::int64_t cast = 0;
  for (int done = 0; done < tasks; done += tasks_at_once) {
    std::vector<RowBlock> blocks(std::min(tasks_at_once, tasks - done));
    tbb::parallel_for(0, int(blocks.size()), [&](int index) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
      const std::int32_t first = start + (done + index) * kRowsPerTask, last = std::min(first + kRowsPerTask, end);
      Scratch scratch;
      blocks[index].columns.reserve(std::size_t(last - first) * std::size_t(rows.rays));
      for (std::int32_t row = first; row < last; ++row) cast_row(row, table, scratch, blocks[index]);
    });
    std::size_t more = 0;
    for (const RowBlock& block : blocks) more += block.columns.size();
    if (rows.columns.size() + more <= rows.columns.capacity()) prefault(rows.columns, more);
    for (const RowBlock& block : blocks) {
      rows.columns.insert(rows.columns.end(), block.columns.begin(), block.columns.end());
      for (TransportRows::Mirrored m : block.mirrored) {
        m.row -= start;
        rows.mirrored.push_back(m);
      }
      rows.hit_weights.insert(rows.hit_weights.end(), block.hit_weights.begin(), block.hit_weights.end());
      rows.visible_fractions.insert(rows.visible_fractions.end(), block.visible_fractions.begin(),
                                    block.visible_fractions.end());
      for (const std::int32_t hits : block.hits) rows.starts.push_back(rows.starts.back() + std::uint64_t(hits));
      cast += block.rays;
    }
    progress.update(double(done) / tasks, "rows of form factors", cast);
  }
  if (std::all_of(rows.visible_fractions.begin(), rows.visible_fractions.end(),
                  [](float fraction) { return fraction == 1.0f; }))
    rows.visible_fractions.clear();
  return cast;
}

/// Casts blocks of rays until about as many rays have hit something as a block has rays. Each sample set takes its
/// number of blocks from the hits of the other set, so that its mean stays unbiased.
void RayRows::cast_row(std::int32_t row, const DirectionTable& table, Scratch& scratch, RowBlock& result) const {
  std::array<SampleSet, 2> sets{SampleSet(*this, row, 0, scratch), SampleSet(*this, row, 1, scratch)};
  for (SampleSet& set : sets) cast_block(set, table, set.index * !independent_);
  std::optional<VisibleDensity> density;
  if (visible_fractions_ && kRaysPerBackHit * (sets[0].back_hits + sets[1].back_hits) >= sets[0].cast + sets[1].cast) {
    density.emplace(scene_, ray_scene_, receivers_[row], visible_density_random(seed_, row));
    result.rays += VisibleDensity::kRays;
    for (SampleSet& set : sets) {
      if (density->is_uniform()) break;
      result.rays += set.cast + std::int64_t(set.mirrored.size());
      set.restart();
      set.density = &*density;
      cast_block(set, table, set.index * !independent_);
    }
  }
  result.visible_fractions.insert(result.visible_fractions.end(), 2, density ? density->visible_fraction() : 1.0f);
  const auto block_count = [&](const SampleSet& other) {
    const int hit_count = int(other.columns.size());
    return hit_count == 0 ? 1 : std::min(kMaxSequenceBlocks, (table.count() + hit_count / 2) / hit_count);
  };
  const std::array<int, 2> block_counts{block_count(sets[1]), block_count(sets[0])};
  for (SampleSet& set : sets) {
    for (int block = 1; block < block_counts[set.index]; ++block)
      cast_block(set, table, independent_ ? block : 2 * block + set.index);
    result.columns.insert(result.columns.end(), set.columns.begin(), set.columns.end());
    result.hits.push_back(std::int32_t(set.columns.size()));
    result.hit_weights.push_back(1.0f / float(set.cast));
    result.rays += set.cast + std::int64_t(set.mirrored.size());
    for (auto& m : set.mirrored) {
      m.weight *= result.hit_weights.back();
      result.mirrored.push_back(m);
    }
  }
}

void RayRows::start_packet(const SampleSet& set, const DirectionTable& table, int first, RayPacket& packet) const {
  QuadSamples samples;
  shift_samples(table, first, set.shift, samples);
  if (set.sampler) {
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      Vec2f uv(samples.u[lane], samples.v[lane]);
      if (set.density) uv = (*set.density)(uv);
      if (set.has_mask)
        uv = covered_point(scene_, set.patch, *set.sampler, uv, hash64(set.random + set.sample_number(first + lane)));
      leave_surface(lane, ray_scene_, (*set.sampler)(uv.x, uv.y), set.offset,
                    {samples.dx[lane], samples.dy[lane], samples.dz[lane]}, packet);
    }
    return;
  }
  for (int lane = 0; set.density && lane < RayPacket::kSize; ++lane) {
    const Vec2f uv = (*set.density)(Vec2f(samples.u[lane], samples.v[lane]));
    samples.u[lane] = uv.x;
    samples.v[lane] = uv.y;
  }
  packet.start();
  set_quad_rays(set.quad, samples, packet);
}

void RayRows::cast_block(SampleSet& set, const DirectionTable& table, int block) const {
  const bool coherent = table.count() >= 128;  // measured: neighbours in a coarser table diverge too much
  set.block = block;
  set.shift = table.block(std::uint32_t(block));
  for (int k = 0; k < 4; ++k) set.shift[k] ^= set.digital_shift[k];
  set.cast += table.count();
  RayPacket packet;
  for (int first = 0; first < table.count(); first += RayPacket::kSize) {
    start_packet(set, table, first, packet);
    ray_scene_.intersect(packet, coherent);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      if (hit.front)
        set.columns.push_back(elements_.at(hit.primitive, hit.u, hit.v));
      else if (hit.primitive >= 0)
        ++set.back_hits;
      else if (scene_.environment)
        set.columns.push_back(elements_.sky(packet.direction(lane)));
    }
    if (has_metals_) trace_reflections(set, first, packet);
  }
}

void RayRows::trace_reflections(SampleSet& set, int first, RayPacket& packet) const {
  std::array<Color, RayPacket::kSize> throughput;
  throughput.fill(Color(1.0f));
  for (int bounce = 0; bounce < kMaxMirrorBounces; ++bounce) {
    bool any_active = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      packet.valid[lane] = 0;
      if (bounce > 0 && hit.primitive < 0 && scene_.environment)
        set.mirrored.push_back({set.row, set.index, elements_.sky(packet.direction(lane)), throughput[lane]});
      if (!hit.front) continue;
      if (bounce > 0)
        set.mirrored.push_back({set.row, set.index, elements_.at(hit.primitive, hit.u, hit.v), throughput[lane]});
      if (!metallic_[hit.primitive]) continue;
      const std::uint64_t random =
          hash64(set.random ^ hash64(set.sample_number(first + lane) << 8 | std::uint64_t(bounce)));
      any_active = continue_at_mirror(scene_, ray_scene_, hit, random, lane, packet, throughput[lane]) || any_active;
    }
    if (!any_active) return;
    ray_scene_.intersect(packet, false);
  }
}

}  // namespace patchlight
