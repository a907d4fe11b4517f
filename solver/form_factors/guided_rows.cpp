#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>

#include "solver/form_factors/row_samples.h"

namespace patchlight {

namespace {

constexpr int kLearningRays = 16;   // of a sample set in each sweep
constexpr std::size_t kKnown = 32;  // directions that a sample set of a row keeps
constexpr std::size_t kTaken = 12;  // directions that a guide takes from a neighbour
constexpr std::size_t kNeighbours = 12;
constexpr float kMinAlike = 0.7f;  // cosine between the normals of neighbours
constexpr float kMaxGuide = 0.5f;  // form factor of a guide that is worth more rays
constexpr int kGuidedBlock = 16;   // of the sequence, beyond the blocks of other rays
constexpr int kPatchBlocks = 1;    // guided blocks of a patch's sample set
constexpr int kPointBlocks = 2;    // least number of a point's, whose noise no area evens out
constexpr int kLearningBlock = 1 << 20;

/// Step by which at most `count` of `all` are taken.
std::size_t step_for(std::size_t all, std::size_t count) {
  return std::max<std::size_t>(1, (all + count - 1) / count);
}

}  // namespace

/// Sets the neighbours of rows[at]: the nearest that face alike.
void RayRows::find_neighbours(std::span<SkyRow> rows, std::size_t at) {
  SkyRow& row = rows[at];
  std::vector<std::pair<float, std::int32_t>> near;
  const std::size_t last = std::min(rows.size() - 1, at + kGuideReach);
  for (std::size_t j = at - std::min<std::size_t>(at, kGuideReach); j <= last; ++j)
    if (j != at && (rows[j].normal ^ row.normal) > kMinAlike)
      near.emplace_back((rows[j].position - row.position).length2(), std::int32_t(j));
  const std::size_t count = std::min(near.size(), kNeighbours);
  std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(count), near.end());
  for (std::size_t k = 0; k < count; ++k) row.neighbours.push_back(near[k].second);
}

/// A guide to what a sample set of rows[at] and of its neighbours found; empty: nothing.
std::optional<SkyGuide> RayRows::guide(std::span<const SkyRow> rows, std::size_t at, int sample_set) {
  const SkyRow& row = rows[at];
  std::vector<Vec2f> all;
  all.reserve(kKnown + kNeighbours * kTaken);
  all = row.known[sample_set];
  for (const std::int32_t neighbour : row.neighbours) {
    const Vec3f& normal = rows[neighbour].normal;
    const std::vector<Vec2f>& known = rows[neighbour].known[sample_set];
    for (std::size_t k = 0; k < known.size(); k += step_for(known.size(), kTaken)) {
      const Vec2f direction = normal == row.normal ? known[k] : turned_direction(known[k], normal, row.normal);
      if (direction.x <= 1.0f) all.push_back(direction);
    }
  }
  return all.empty() ? std::nullopt : std::optional<SkyGuide>(all);
}

/// Casts a block of a sample set's rays in directions of the guide. Calls act(place, direction) for each ray that hits
/// nothing: its place in the guide's unit square, and its direction in world space.
template <class Act>
void RayRows::cast_guided(SampleSet& set, const SkyGuide& guide, const DirectionTable& table, Act act) const {
  RayPacket packet;
  for (int first = 0; first < table.count(); first += RayPacket::kSize) {
    QuadSamples samples;
    shift_samples(table, first, set.shift, samples);
    std::array<Vec2f, RayPacket::kSize> at;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      at[lane] = guide.point(set.direction_sample(table, first + lane));
      const Vec3f direction = cosine_direction(at[lane].x, at[lane].y);
      samples.dx[lane] = direction.x;
      samples.dy[lane] = direction.y;
      samples.dz[lane] = direction.z;
    }
    start_packet(set, samples, first, packet);
    const std::uint32_t reaching = reaching_sky(set, first, packet);
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      if (reaching >> lane & 1u) act(at[lane], packet.direction(lane));
  }
}

/// Adds guided rays to blocks of consecutive rows.
void RayRows::guide_to_sky(std::span<RowBlock> blocks, const Tables& tables) const {
  std::vector<SkyRow> rows;
  bool any_rare = false, any_found = false;
  for (RowBlock& block : blocks)
    for (SkyRow& row : block.sky) {
      for (int s = 0; s < 2; ++s) {
        for (std::size_t k = 0; k < row.found[s].size(); k += step_for(row.found[s].size(), kKnown))
          row.known[s].push_back(row.found[s][k]);
        any_rare = any_rare || row.is_rare(s);
        any_found = any_found || !row.found[s].empty();
      }
      rows.push_back(std::move(row));
    }
  if (!any_rare || !any_found) return;
  const std::int32_t first = blocks.front().first;
  tbb::parallel_for(std::size_t(0), rows.size(), [&](std::size_t i) {
    if (rows[i].is_rare(0) || rows[i].is_rare(1)) find_neighbours(rows, i);
  });
  for (int sweep = 0; sweep < kGuideSweeps; ++sweep) learn_sky(rows, first, sweep);
  tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t k) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    add_guided(rows, first, tables, blocks[k]);
  });
}

/// Casts rays into the guides, so that rows get to know what other rows found. `rows`: from row `first` on.
void RayRows::learn_sky(std::span<SkyRow> rows, std::int32_t first, int sweep) const {
  const DirectionTable table(kLearningRays);
  std::vector<std::array<std::vector<Vec2f>, 2>> learned(rows.size());
  tbb::parallel_for(std::size_t(0), rows.size(), [&](std::size_t i) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    Scratch scratch;
    for (int s = 0; s < 2; ++s) {
      const std::optional<SkyGuide> known = rows[i].is_rare(s) ? guide(rows, i, s) : std::nullopt;
      if (!known) continue;
      SampleSet set(*this, first + std::int32_t(i), s, scratch);
      set.density = rows[i].density ? &*rows[i].density : nullptr;
      set.begin(table, kLearningBlock + sweep);
      rows[i].learning_rays += table.count();
      cast_guided(set, *known, table, [&](const Vec2f& at, const Vec3f&) { learned[i][s].push_back(at); });
    }
  });
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int s = 0; s < 2; ++s) {
      std::vector<Vec2f>& known = rows[i].known[s];
      known.insert(known.begin(), learned[i][s].begin(), learned[i][s].end());
      if (known.size() > kKnown) known.resize(kKnown);
    }
}

/// Adds guided rays to the sample sets of a block's rows. `rows`: all rows from row `first` on.
void RayRows::add_guided(std::span<const SkyRow> rows, std::int32_t first, const Tables& tables,
                         RowBlock& block) const {
  const std::vector<std::int32_t> columns = std::move(block.columns);
  block.columns.clear();
  auto column = columns.begin();
  auto mirrored = block.mirrored.begin();
  Scratch scratch;
  for (std::size_t k = 0; k < block.hits.size(); ++k) {
    const auto i = std::size_t(block.first - first) + k / 2;
    const auto end = column + block.hits[k];
    const int s = int(k % 2), other = 1 - s;
    const SkyRow& row = rows[i];
    std::optional<SkyGuide> open = row.is_rare(other) ? guide(rows, i, other) : std::nullopt;
    if (open && open->area() > kMaxGuide) open.reset();
    if (s == 0) block.rays += row.learning_rays;
    const std::size_t sky_before = block.sky_columns.size(), before = block.columns.size();
    const auto inside = [&](std::size_t found) { return open && open->contains(row.found[s][found]); };
    std::size_t found = 0;
    for (; column != end; ++column) {
      const bool is_sky = elements_.is_sky(*column);
      (is_sky && inside(found) ? block.sky_columns : block.columns).push_back(*column);
      found += is_sky;
    }
    const std::size_t guided_before = block.sky_columns.size();
    float weight = 0.0f, rest = block.hit_weights[k];
    if (open) {
      SampleSet set(*this, block.first + std::int32_t(k / 2), s, scratch);
      const DirectionTable& table = tables.of(*this, set.row);
      set.density = row.density ? &*row.density : nullptr;
      const int guided_blocks = set.patch.area > 0 ? kPatchBlocks : std::max(kPointBlocks, least_blocks(set.row));
      for (int b = 0; b < guided_blocks; ++b) {
        set.begin(table, kGuidedBlock + s * guided_blocks + b);
        cast_guided(set, *open, table, [&](const Vec2f&, const Vec3f& direction) {
          block.sky_columns.push_back(elements_.sky(direction));
        });
      }
      const int guided = guided_blocks * table.count();
      block.rays += guided;
      const float uniform = float(row.cast[s]), uniform_inside = float(guided_before - sky_before);
      weight = 1.0f / (uniform + float(guided) / open->area());
      if (uniform > uniform_inside)
        rest = (1.0f - weight * float(block.sky_columns.size() - sky_before)) / (uniform - uniform_inside);
    }
    for (; mirrored != block.mirrored.end() && mirrored->row == block.first + std::int32_t(k / 2) &&
           mirrored->sample_set == s;
         ++mirrored)
      mirrored->weight *= rest / block.hit_weights[k];
    block.hit_weights[k] = rest;
    block.hits[k] = std::int32_t(block.columns.size() - before);
    block.sky_hits[k] = std::int32_t(block.sky_columns.size() - sky_before);
    block.sky_weights[k] = weight;
  }
}

}  // namespace patchlight
