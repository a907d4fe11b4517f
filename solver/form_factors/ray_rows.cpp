#include "solver/form_factors/ray_rows.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "pipeline/optics/cuts/cell_cutter.h"
#include "pipeline/system/prefaulted_memory.h"
#include "solver/form_factors/coated_rows.h"
#include "solver/form_factors/row_samples.h"

namespace patchlight {

namespace {

constexpr int kRowsPerTask = 16;
constexpr std::int64_t kRaysAtOnce = 1 << 18;           // between two checks for an interrupt
constexpr std::int64_t kRaysAtOnceForGuides = 1 << 21;  // since rows around them are cast for guides only

constexpr int kMaxSequenceBlocks = 8;  // for a row most of whose rays hit nothing
constexpr int kRaysPerBackHit = 64;    // with more hits of unlit backs, rays start with a VisibleDensity

}  // namespace

RayRows::RayRows(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers,
                 const Elements& elements, std::uint64_t seed, bool visible_fractions,
                 std::span<const std::uint8_t> ray_factors)
    : scene_(scene),
      ray_scene_(ray_scene),
      receivers_(receivers),
      elements_(elements),
      seed_(hash64(seed)),
      visible_fractions_(visible_fractions),
      ray_factors_(ray_factors) {
  for (const Primitive& p : scene.primitives) {
    finish_.push_back(lets_light_pass(scene, p)                  ? Finish::passable
                      : passes_by_chance(scene, p)               ? Finish::coated
                      : is_specular(scene.materials[p.material]) ? Finish::specular
                                                                 : Finish::diffuse);
    has_specular_ = has_specular_ || finish_.back() != Finish::diffuse;
  }
}

/// Rows `first` to `last` - 1; with an environment also, for their guides, those around them.
std::vector<RayRows::RowBlock> RayRows::row_blocks(std::int32_t first, std::int32_t last) const {
  const std::int32_t around = scene_.environment ? kRowsForGuides : 0, count = std::int32_t(receivers_.size());
  std::vector<RowBlock> blocks;
  const auto add = [&](std::int32_t from, std::int32_t to) {
    for (; from < to; from += kRowsPerTask) {
      RowBlock& block = blocks.emplace_back();
      block.first = from;
      block.last = std::min(from + kRowsPerTask, to);
    }
  };
  add(std::max(0, first - around), first);
  add(first, last);
  add(last, std::min(count, last + around));
  return blocks;
}

std::int64_t RayRows::cast(int rays, TransportRows& rows, Progress& progress, Shard shard) const {
  const auto start = std::int32_t(shard.first(receivers_.size())), end = std::int32_t(shard.last(receivers_.size()));
  const int set_rays = std::max(16, (rays + 31) / 32 * 16);
  const Tables tables(set_rays);
  rows = {};
  rows.rays = 2 * set_rays;
  rows.starts.push_back(0);
  rows.sky_starts.push_back(0);
  rows.columns.reserve(std::size_t(end - start) * std::size_t(rows.rays));
  const std::int64_t rays_at_once = scene_.environment ? kRaysAtOnceForGuides : kRaysAtOnce;
  const auto rows_at_once =
      std::int32_t(std::max(std::int64_t(1), rays_at_once / (rows.rays * kRowsPerTask)) * kRowsPerTask);
  std::int64_t cast = 0;
  for (std::int32_t first = start; first < end; first += rows_at_once) {
    const std::int32_t last = std::min(first + rows_at_once, end);
    std::vector<RowBlock> blocks = row_blocks(first, last);
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t index) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
      RowBlock& block = blocks[index];
      Scratch scratch;
      block.columns.reserve(std::size_t(block.last - block.first) * std::size_t(rows.rays));
      for (std::int32_t row = block.first; row < block.last; ++row) cast_row(row, tables, scratch, block);
    });
    if (scene_.environment) guide_to_sky(blocks, tables);
    std::erase_if(blocks, [&](const RowBlock& block) { return block.first < first || block.first >= last; });
    append(blocks, start, rows);
    for (const RowBlock& block : blocks) cast += block.rays;
    progress.update(double(last - start) / double(end - start), "rows of form factors", cast);
  }
  if (std::all_of(rows.visible_fractions.begin(), rows.visible_fractions.end(),
                  [](float fraction) { return fraction == 1.0f; }))
    rows.visible_fractions.clear();
  if (rows.sky_columns.empty()) {
    rows.sky_starts.clear();
    rows.sky_weights.clear();
  }
  return cast;
}

/// Appends blocks to `rows`, whose first row is row `start` of the receivers.
void RayRows::append(std::span<const RowBlock> blocks, std::int32_t start, TransportRows& rows) {
  const auto add = [](auto& values, const auto& more) { values.insert(values.end(), more.begin(), more.end()); };
  std::size_t more = 0;
  for (const RowBlock& block : blocks) more += block.columns.size();
  if (rows.columns.size() + more <= rows.columns.capacity()) prefault(rows.columns, more);
  for (const RowBlock& block : blocks) {
    add(rows.columns, block.columns);
    for (TransportRows::Mirrored m : block.mirrored) {
      m.row -= start;
      rows.mirrored.push_back(m);
    }
    add(rows.hit_weights, block.hit_weights);
    add(rows.visible_fractions, block.visible_fractions);
    for (const std::int32_t hits : block.hits) rows.starts.push_back(rows.starts.back() + std::uint64_t(hits));
    add(rows.sky_columns, block.sky_columns);
    add(rows.sky_weights, block.sky_weights);
    for (const std::int32_t hits : block.sky_hits)
      rows.sky_starts.push_back(rows.sky_starts.back() + std::uint64_t(hits));
  }
}

/// Casts blocks of rays until about as many rays have hit something as a block has rays. Each sample set takes its
/// number of blocks from the hits of the other set, so that its mean stays unbiased.
void RayRows::cast_row(std::int32_t row, const Tables& tables, Scratch& scratch, RowBlock& result) const {
  const DirectionTable& table = tables.of(*this, row);
  std::array<SampleSet, 2> sets{SampleSet(*this, row, 0, scratch), SampleSet(*this, row, 1, scratch)};
  for (SampleSet& set : sets) cast_block(set, table, 0);
  std::optional<VisibleDensity> density;
  if (visible_fractions_ && kRaysPerBackHit * (sets[0].back_hits + sets[1].back_hits) >= sets[0].cast + sets[1].cast) {
    density.emplace(scene_, ray_scene_, receivers_[row], visible_density_random(seed_, row));
    result.rays += VisibleDensity::kRays;
    for (SampleSet& set : sets) {
      if (density->is_uniform()) break;
      result.rays += set.cast + std::int64_t(set.mirrored.size());
      set.restart();
      set.density = &*density;
      cast_block(set, table, 0);
    }
  }
  result.visible_fractions.insert(result.visible_fractions.end(), 2, density ? density->visible_fraction() : 1.0f);
  const auto block_count = [&](const SampleSet& other) {
    const int hit_count = int(other.columns.size()) + other.back_hits;
    return hit_count == 0 ? 1 : std::min(kMaxSequenceBlocks, (table.count() + hit_count / 2) / hit_count);
  };
  const int least = least_blocks(row);
  const std::array<int, 2> block_counts{std::max(least, block_count(sets[1])), std::max(least, block_count(sets[0]))};
  for (SampleSet& set : sets) {
    for (int block = 1; block < block_counts[set.index]; ++block) cast_block(set, table, block);
    result.columns.insert(result.columns.end(), set.columns.begin(), set.columns.end());
    result.hits.push_back(std::int32_t(set.columns.size()));
    result.hit_weights.push_back(1.0f / float(set.cast));
    result.rays += set.cast + std::int64_t(set.mirrored.size());
    for (auto& m : set.mirrored) {
      m.weight *= result.hit_weights.back();
      result.mirrored.push_back(m);
    }
  }
  if (!scene_.environment) return;
  result.sky_hits.insert(result.sky_hits.end(), 2, 0);
  result.sky_weights.insert(result.sky_weights.end(), 2, 0.0f);
  SkyRow& sky = result.sky.emplace_back();
  sky.position = ray_scene_.to_local(receivers_[row].center);
  sky.normal = receivers_[row].normal;
  for (SampleSet& set : sets) {
    sky.found[set.index] = std::move(set.sky);
    sky.cast[set.index] = set.cast;
  }
  if (density && !density->is_uniform()) sky.density = std::move(density);
}

/// Starts rays from the samples, which are the block's from `first` on.
void RayRows::start_packet(const SampleSet& set, QuadSamples& samples, int first, RayPacket& packet) const {
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
  // Measured with Embree: neighbours in a coarser table diverge too much.
  const bool coherent = table.count() >= (ray_scene_.mostly_fine() ? 2048 : 128);
  set.begin(table, block);
  set.cast += table.count();
  RayPacket packet;
  for (int first = 0; first < table.count(); first += RayPacket::kSize) {
    QuadSamples samples;
    shift_samples(table, first, set.shift, samples);
    start_packet(set, samples, first, packet);
    ray_scene_.intersect(packet, coherent);
    Reflections reflections;
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      if (!(packet.passable >> lane & 1u)) meet(set, table, first, lane, packet, reflections);
    if (packet.passable != 0) pass_surfaces(set, table, first, packet, reflections);
    if (has_specular_) trace_reflections(set, first, packet, reflections);
  }
}

/// Takes account of what a ray of the block that goes straight meets first; a coat may reflect it.
void RayRows::meet(SampleSet& set, const DirectionTable& table, int first, int lane, RayPacket& packet,
                   Reflections& reflections) const {
  const SurfaceHit hit = ray_scene_.hit(packet, lane);
  if (hit.front) {
    if (finish_[hit.primitive] == Finish::coated) {
      Color passed;
      if (reflects_at_coat(hit, set.ray_random(first + lane, 0), lane, packet, reflections.throughput[lane], passed)) {
        reflections.started |= 1u << lane;
        return;
      }
      if (passed != Color(1.0f)) {
        set.mirrored.push_back({set.row, set.index, elements_.at(hit.primitive, hit.u, hit.v), passed});
        return;
      }
    }
    const Elements::Place place = elements_.find(hit.primitive, hit.u, hit.v);
    const bool certain = !hit.at_edge && !place.cut;
    const std::int32_t element = certain ? place.element : certain_element(packet, lane, hit);
    if (element < 0) return;
    set.columns.push_back(element);
    if (elements_.is_sky(element)) set.sky.push_back(set.direction_sample(table, first + lane));
  } else if (hit.primitive >= 0) {
    ++set.back_hits;
  } else if (scene_.environment) {
    set.columns.push_back(elements_.sky(packet.direction(lane)));
    set.sky.push_back(set.direction_sample(table, first + lane));
  }
}

/// The element that a ray hits at the edge of a quad or on a cut face, where rounding may put the hit behind what
/// stands there: the ray is turned a little until it hits no edge, and the hit is taken back by the rounding. -1: none.
std::int32_t RayRows::certain_element(const RayPacket& packet, int lane, SurfaceHit hit) const {
  constexpr int kAttempts = 4;
  constexpr float kTurn = 0.01f;  // rad
  const Vec3f origin = packet.origin(lane);
  Vec3f direction = packet.direction(lane);
  for (int k = 0; k < kAttempts && hit.at_edge; ++k) {
    const std::uint64_t random =
        hash64(hash64(std::bit_cast<std::uint32_t>(direction.x)) ^ std::bit_cast<std::uint32_t>(direction.z));
    Vec3f along, across;
    orthonormal_frame(direction, along, across);
    const float angle = float(2 * kPi) * uniform01(random);
    direction = (direction + (along * std::cos(angle) + across * std::sin(angle)) * kTurn).normalized();
    RayPacket turned;
    turned.clear();
    turned.set(0, origin, direction);
    ray_scene_.intersect(turned, false);
    hit = ray_scene_.hit(turned, 0);
  }
  if (hit.primitive < 0) return elements_.sky(direction);
  if (!hit.front || hit.at_edge) return -1;
  const Elements::Place place = elements_.find(hit.primitive, hit.u, hit.v);
  if (!place.cut) return place.element;
  const Primitive& primitive = scene_.primitives[hit.primitive];
  const double rounding = position_rounding(primitive) + ray_scene_.offset(hit.primitive);
  const Vec3d before = position_at(primitive.corners, hit.u, hit.v) - Vec3d(direction) * rounding;
  const Vec2f uv(uv_of(primitive, before));
  return elements_.at(hit.primitive, uv.x, uv.y);
}

}  // namespace patchlight
