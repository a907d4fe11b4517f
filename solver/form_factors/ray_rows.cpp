#include "solver/form_factors/ray_rows.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/mirror_path.h"
#include "pipeline/system/prefaulted_memory.h"
#include "pipeline/system/vector_code.h"
#include "solver/form_factors/visible_area_fraction.h"

namespace patchlight {

namespace {

constexpr int kBlock = 16;                     // rows that a thread casts at a time
constexpr std::int64_t kRaysAtOnce = 1 << 18;  // between two looks at the signals

constexpr int kMostBlocks = 8;  // of rays, for a row that sees little
constexpr int kFewBacks = 64;   // one ray in so many may end on a back before a row's parts are looked at

using Lanes = std::array<float, RayPacket::kSize>;

/// Sixteen directions about +Z and points of the unit square.
struct Samples {
  float *dx, *dy, *dz, *u, *v;
};

/// A quad patch in the scene's local frame: p = corner + u along_u + v along_v + uv twist.
struct QuadPatch {
  Vec3f corner, along_u, along_v, twist;
  Vec3f tangent, bitangent, normal;
  std::array<float, 4> density;  ///< Area per (u,v) at the corners 00, 10, 01, 11.
};

/// Sine and cosine of a part of a full turn in [0,1], to 3e-7; loops over it become vector code.
inline void turn(float part, float& sine, float& cosine) {
  const int quarter = int(4.0f * part + 0.5f);
  const float a = float(2 * kPi) * (part - 0.25f * float(quarter)), b = a * a;
  const float s = a * (1.0f + b * (-1.0f / 6 + b * (1.0f / 120 - b * (1.0f / 5040))));
  const float c = 1.0f + b * (-0.5f + b * (1.0f / 24 + b * (-1.0f / 720 + b * (1.0f / 40320))));
  const bool odd = quarter & 1;
  const float x = odd ? c : s, y = odd ? s : c;
  sine = quarter & 2 ? -x : x;
  cosine = (quarter + 1) & 2 ? -y : y;
}

/// Inverts the distribution whose density runs linearly from a to b over [0,1] (Pharr et al. 2023, section A.5.1).
inline float sample_linear(float x, float a, float b) {
  constexpr float kTiny = 1e-30f;
  return std::min(x * (a + b) / (a + std::sqrt((1.0f - x) * a * a + x * b * b) + kTiny), 1.0f);
}

VECTOR_CODE void shift_samples(const DirectionTable& table, int first, const std::array<std::uint32_t, 4>& shift,
                               const Samples& to) {
  const std::uint32_t *x = table.x.data() + first, *y = table.y.data() + first;
  const std::uint32_t *u = table.u.data() + first, *v = table.v.data() + first;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float square = unit_of(x[lane] ^ shift[0]);
    float sine, cosine;
    turn(unit_of(y[lane] ^ shift[1]), sine, cosine);
    const float radius = std::sqrt(square);
    to.dx[lane] = radius * cosine;
    to.dy[lane] = radius * sine;
    to.dz[lane] = std::sqrt(1.0f - square);
    to.u[lane] = unit_of(u[lane] ^ shift[2]);
    to.v[lane] = unit_of(v[lane] ^ shift[3]);
  }
}

VECTOR_CODE void place_rays(const QuadPatch& patch, const Samples& at, RayPacket& packet) {
  const auto& d = patch.density;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float v = sample_linear(at.v[lane], d[0] + d[1], d[2] + d[3]);
    at.u[lane] = sample_linear(at.u[lane], d[0] * (1.0f - v) + d[2] * v, d[1] * (1.0f - v) + d[3] * v);
    at.v[lane] = v;
  }
  auto& ray = packet.rays.ray;
  float* const origins[] = {ray.org_x, ray.org_y, ray.org_z};
  float* const directions[] = {ray.dir_x, ray.dir_y, ray.dir_z};
  for (int k = 0; k < 3; ++k) {
    const float c = patch.corner[k], along_u = patch.along_u[k], along_v = patch.along_v[k], twist = patch.twist[k];
    const float t = patch.tangent[k], b = patch.bitangent[k], n = patch.normal[k];
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      origins[k][lane] = c + at.u[lane] * (along_u + at.v[lane] * twist) + at.v[lane] * along_v;
      directions[k][lane] = t * at.dx[lane] + b * at.dy[lane] + n * at.dz[lane];
    }
  }
}

}  // namespace

/// What a row's halves have met, kept from row to row for its memory.
struct RayRows::Scratch {
  std::array<std::vector<std::int32_t>, 2> columns;
  std::array<std::vector<TransportRows::Mirrored>, 2> mirrored;
};

/// One half of a row in the making.
struct RayRows::SampleSet {
  SampleSet(const RayRows& rows, std::int32_t row_index, int index, Scratch& scratch)
      : row(row_index),
        which(index),
        random(hash64(rows.seed_ ^ hash64(2 * std::uint64_t(row_index) + std::uint64_t(index)))),
        patch(rows.receivers_[row_index]),
        primitive(rows.scene_.primitives[patch.primitive]),
        offset(rows.ray_scene_.offset(patch.primitive)),
        columns(scratch.columns[index]),
        mirrored(scratch.mirrored[index]) {
    columns.clear();
    mirrored.clear();
    const std::uint64_t own = rows.separate_ ? random : hash64(rows.seed_ ^ std::uint64_t(row_index));
    for (int k = 0; k < 4; ++k) turned[k] = std::uint32_t((k < 2 ? own : hash64(own)) >> 32 * (k % 2));
    has_holes = has_alpha_mask(rows.scene_, patch);
    if (primitive.shape != Primitive::Shape::quad || has_holes) {
      sampler.emplace(primitive, patch);
      return;
    }
    const auto corner_at = [&](float u, float v) {
      return rows.ray_scene_.to_local(point_at(primitive, u, v).position);
    };
    const Vec3f c00 = corner_at(patch.u0, patch.v0), c10 = corner_at(patch.u1, patch.v0);
    const Vec3f c01 = corner_at(patch.u0, patch.v1), c11 = corner_at(patch.u1, patch.v1);
    const Vec3f u0 = c10 - c00, v0 = c01 - c00, u1 = c11 - c01, v1 = c11 - c10;
    Vec3f tangent, bitangent;
    orthonormal_frame(patch.normal, tangent, bitangent);
    quad = {c00 + patch.normal * offset,
            u0,
            v0,
            u1 - u0,
            tangent,
            bitangent,
            patch.normal,
            {(u0 % v0).length(), (u0 % v1).length(), (u1 % v0).length(), (u1 % v1).length()}};
  }

  std::int32_t row;
  int which;  ///< 0 or 1.
  std::uint64_t random;
  std::array<std::uint32_t, 4> turned;  ///< How the whole sequence is scrambled.
  const Patch& patch;
  const Primitive& primitive;
  float offset;
  std::optional<PatchSampler> sampler;  ///< Of a sphere, or of what has cut-outs.
  bool has_holes = false;
  QuadPatch quad{};

  int block = 0;                                   ///< Of the sequence, that is being cast.
  std::array<std::uint32_t, 4> shift;              ///< See DirectionTable::block().
  std::int32_t cast = 0, backs = 0;                ///< Rays, and those that ended on unlit backs.
  std::vector<std::int32_t>& columns;              ///< Of those that met something lit.
  std::vector<TransportRows::Mirrored>& mirrored;  ///< With weights for one ray.

  std::uint64_t number(int ray) const { return std::uint64_t(block) << 32 | std::uint64_t(ray); }
};

RayRows::RayRows(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers,
                 const Elements& elements, std::uint64_t seed, SampleSets sets, bool visible_fractions)
    : scene_(scene),
      ray_scene_(ray_scene),
      receivers_(receivers),
      elements_(elements),
      seed_(hash64(seed)),
      visible_fractions_(visible_fractions),
      separate_(sets == SampleSets::separate) {
  for (const Primitive& p : scene.primitives) {
    metallic_.push_back(scene.materials[p.material].specular != Color(0.0f));
    has_metals_ = has_metals_ || metallic_.back();
  }
}

std::int64_t RayRows::cast(int rays, TransportRows& to, Progress& progress, Shard shard) const {
  const auto start = std::int32_t(shard.first(receivers_.size())), end = std::int32_t(shard.last(receivers_.size()));
  const std::int32_t count = end - start;
  const int half_rays = std::max(16, (rays + 31) / 32 * 16);
  const DirectionTable table(half_rays);
  to = {};
  to.rays = 2 * half_rays;
  to.starts.push_back(0);
  to.columns.reserve(std::size_t(count) * std::size_t(to.rays));
  const int blocks = (count + kBlock - 1) / kBlock;
  const int blocks_at_once = std::max(1, int(kRaysAtOnce / (2 * half_rays * kBlock)));
  std::int64_t cast = 0;
  for (int done = 0; done < blocks; done += blocks_at_once) {
    std::vector<Found> found(std::min(blocks_at_once, blocks - done));
    tbb::parallel_for(0, int(found.size()), [&](int index) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      const std::int32_t first = start + (done + index) * kBlock, last = std::min(first + kBlock, end);
      Scratch scratch;
      found[index].columns.reserve(std::size_t(last - first) * std::size_t(to.rays));
      for (std::int32_t row = first; row < last; ++row) cast_row(row, table, scratch, found[index]);
    });
    std::size_t more = 0;
    for (const Found& part : found) more += part.columns.size();
    if (to.columns.size() + more <= to.columns.capacity()) prefault(to.columns, more);
    for (const Found& part : found) {
      to.columns.insert(to.columns.end(), part.columns.begin(), part.columns.end());
      for (TransportRows::Mirrored m : part.mirrored) {
        m.row -= start;
        to.mirrored.push_back(m);
      }
      to.hit_weights.insert(to.hit_weights.end(), part.hit_weights.begin(), part.hit_weights.end());
      to.visible_fractions.insert(to.visible_fractions.end(), part.visible_fractions.begin(),
                                  part.visible_fractions.end());
      for (const std::int32_t hits : part.hits) to.starts.push_back(to.starts.back() + std::uint64_t(hits));
      cast += part.rays;
    }
    progress.update(double(done) / blocks, "rows of form factors", cast);
  }
  if (std::all_of(to.visible_fractions.begin(), to.visible_fractions.end(), [](float part) { return part == 1.0f; }))
    to.visible_fractions.clear();
  return cast;
}

/// Rays go on in blocks until about as many have met something as the first block has rays. How many blocks that takes
/// each half learns from the other, so that neither's mean depends on it.
void RayRows::cast_row(std::int32_t row, const DirectionTable& table, Scratch& scratch, Found& found) const {
  std::array<SampleSet, 2> sets{SampleSet(*this, row, 0, scratch), SampleSet(*this, row, 1, scratch)};
  for (SampleSet& set : sets) cast_block(set, table, set.which * !separate_);
  const int backs = sets[0].backs + sets[1].backs;
  std::array<float, 2> parts{1.0f, 1.0f};
  if (visible_fractions_ && kFewBacks * backs >= sets[0].cast + sets[1].cast)
    for (int set = 0; set < 2; ++set) {
      const int rays = std::max(kMinRaysForVisibleFraction, 4 * table.count());
      parts[set] =
          visible_area_fraction(scene_, ray_scene_, receivers_[row], rays, hash64(sets[set].random), found.rays);
    }
  found.visible_fractions.insert(found.visible_fractions.end(), parts.begin(), parts.end());
  const auto blocks = [&](const SampleSet& other) {
    const int hit_count = int(other.columns.size());
    return hit_count == 0 ? 1 : std::min(kMostBlocks, (table.count() + hit_count / 2) / hit_count);
  };
  const std::array<int, 2> wanted{blocks(sets[1]), blocks(sets[0])};
  for (SampleSet& set : sets) {
    for (int block = 1; block < wanted[set.which]; ++block)
      cast_block(set, table, separate_ ? block : 2 * block + set.which);
    found.columns.insert(found.columns.end(), set.columns.begin(), set.columns.end());
    found.hits.push_back(std::int32_t(set.columns.size()));
    found.hit_weights.push_back(1.0f / (float(set.cast) * parts[set.which]));
    found.rays += set.cast + std::int64_t(set.mirrored.size());
    for (auto& m : set.mirrored) {
      m.weight *= found.hit_weights.back();
      found.mirrored.push_back(m);
    }
  }
}

void RayRows::start_packet(const SampleSet& set, const DirectionTable& table, int first, RayPacket& packet) const {
  Lanes dx, dy, dz, u, v;
  shift_samples(table, first, set.shift, {dx.data(), dy.data(), dz.data(), u.data(), v.data()});
  if (set.sampler) {
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      Vec2f at(u[lane], v[lane]);
      if (set.has_holes)
        at = covered_point(scene_, set.patch, *set.sampler, at, hash64(set.random + set.number(first + lane)));
      leave_surface(lane, ray_scene_, (*set.sampler)(at.x, at.y), set.offset, {dx[lane], dy[lane], dz[lane]}, packet);
    }
    return;
  }
  packet.start();
  place_rays(set.quad, {dx.data(), dy.data(), dz.data(), u.data(), v.data()}, packet);
}

void RayRows::cast_block(SampleSet& set, const DirectionTable& table, int block) const {
  const bool coherent = table.count() >= 128;  // measured: neighbours in a coarser table part too soon
  set.block = block;
  set.shift = table.block(std::uint32_t(block));
  for (int k = 0; k < 4; ++k) set.shift[k] ^= set.turned[k];
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
        ++set.backs;
      else if (scene_.environment)
        set.columns.push_back(elements_.sky(packet.direction(lane)));
    }
    if (has_metals_) follow_mirrors(set, first, packet);
  }
}

void RayRows::follow_mirrors(SampleSet& set, int first, RayPacket& packet) const {
  std::array<Color, RayPacket::kSize> throughput;
  throughput.fill(Color(1.0f));
  for (int bounce = 0; bounce < kMostMirrors; ++bounce) {
    bool going = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      packet.valid[lane] = 0;
      if (bounce > 0 && hit.primitive < 0 && scene_.environment)
        set.mirrored.push_back({set.row, set.which, elements_.sky(packet.direction(lane)), throughput[lane]});
      if (!hit.front) continue;
      Color& kept = throughput[lane];
      if (bounce > 0) set.mirrored.push_back({set.row, set.which, elements_.at(hit.primitive, hit.u, hit.v), kept});
      if (!metallic_[hit.primitive]) continue;
      const std::uint64_t random = hash64(set.random ^ hash64(set.number(first + lane) << 8 | std::uint64_t(bounce)));
      going = go_on(scene_, ray_scene_, hit, random, lane, packet, kept) || going;
    }
    if (!going) return;
    ray_scene_.intersect(packet, false);
  }
}

}  // namespace patchlight
