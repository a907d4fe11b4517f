#include "solver/ray_rows.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"
#include "solver/mirror_path.h"
#include "solver/vector_code.h"

namespace patchlight {

namespace {

constexpr int kBlock = 64;                     // rows that a thread casts at a time
constexpr std::int64_t kRaysAtOnce = 1 << 21;  // between two looks at the signals

constexpr std::int32_t kLeftOut = -1;

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

VECTOR_CODE void shift_samples(const DirectionTable& table, int first, const std::array<float, 4>& shift,
                               const Samples& to) {
  const float *x = table.x.data() + first, *y = table.y.data() + first;
  const float *u = table.u.data() + first, *v = table.v.data() + first;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float square = shifted(x[lane], shift[0]);
    float sine, cosine;
    turn(shifted(y[lane], shift[1]), sine, cosine);
    const float radius = std::sqrt(square);
    to.dx[lane] = radius * cosine;
    to.dy[lane] = radius * sine;
    to.dz[lane] = std::sqrt(1.0f - square);
    to.u[lane] = shifted(u[lane], shift[2]);
    to.v[lane] = shifted(v[lane], shift[3]);
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

/// Takes out what is left out; what came by mirrors weighs the more.
void close_ranks(TransportRows& rows) {
  std::vector<float> scale(2 * std::size_t(rows.rows()), 1.0f);
  std::uint64_t begin = 0, kept = 0;
  for (std::size_t k = 0; k + 1 < rows.starts.size(); ++k) {
    const std::uint64_t end = rows.starts[k + 1], first = kept;
    for (std::uint64_t at = begin; at < end; ++at)
      if (rows.ends[at] != kLeftOut) rows.ends[kept++] = rows.ends[at];
    if (kept > first) scale[k] = float(end - begin) / float(kept - first);
    rows.starts[k + 1] = kept;
    begin = end;
  }
  rows.ends.resize(kept);
  for (auto& m : rows.mirrored) m.weight *= scale[2 * std::size_t(m.row) + std::size_t(m.half)];
}

}  // namespace

/// One half of a row in the making.
struct RayRows::Half {
  Half(const RayRows& rows, std::int32_t row_index, int which)
      : row(row_index),
        half(which),
        random(scramble(rows.seed_ ^ scramble(2 * std::uint64_t(row_index) + std::uint64_t(which)))),
        patch(rows.receivers_[row_index]),
        primitive(rows.scene_.primitives[patch.primitive]),
        offset(rows.ray_scene_.offset(patch.primitive)) {
    shift = {to_unit(random), to_unit(random << 24), to_unit(scramble(random)), to_unit(scramble(random) << 24)};
    if (primitive.shape != Primitive::Shape::quad) {
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
  int half;
  std::uint64_t random;
  std::array<float, 4> shift;
  const Patch& patch;
  const Primitive& primitive;
  float offset;
  std::optional<PatchSampler> sampler;  ///< Of a sphere.
  QuadPatch quad{};
};

RayRows::RayRows(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers,
                 const Elements& elements, std::uint64_t seed, const ExposedParts* exposed)
    : scene_(scene),
      ray_scene_(ray_scene),
      receivers_(receivers),
      elements_(elements),
      seed_(scramble(seed)),
      exposed_(exposed) {
  for (const Primitive& p : scene.primitives) {
    metallic_.push_back(scene.materials[p.material].specular != Color(0.0f));
    has_metals_ = has_metals_ || metallic_.back();
  }
}

std::int64_t RayRows::cast(int rays, TransportRows& to, Progress& progress) const {
  const auto count = std::int32_t(receivers_.size());
  const int half_rays = std::max(16, (rays + 31) / 32 * 16);
  const DirectionTable table(half_rays);
  to.weights.clear();
  to.mirrored.clear();
  to.ends.resize(2 * std::size_t(count) * half_rays);
  to.starts.resize(2 * std::size_t(count) + 1);
  for (std::size_t k = 0; k < to.starts.size(); ++k) to.starts[k] = k * half_rays;

  const int blocks = (count + kBlock - 1) / kBlock;
  const int blocks_at_once = std::max(1, int(kRaysAtOnce / (2 * half_rays * kBlock)));
  std::int64_t cast = std::int64_t(to.ends.size());
  for (int done = 0; done < blocks; done += blocks_at_once) {
    std::vector<std::vector<TransportRows::Mirrored>> found(std::min(blocks_at_once, blocks - done));
    tbb::parallel_for(0, int(found.size()), [&](int index) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      const std::int32_t first = (done + index) * kBlock, last = std::min(first + kBlock, count);
      for (std::int32_t row = first; row < last; ++row)
        for (int half = 0; half < 2; ++half)
          cast_half(Half(*this, row, half), table, to.ends.data() + to.starts[2 * row + half], found[index]);
    });
    for (const auto& part : found) {
      to.mirrored.insert(to.mirrored.end(), part.begin(), part.end());
      cast += std::int64_t(part.size());
    }
    progress.update(double(done) / blocks, "rows of form factors");
  }
  if (exposed_) close_ranks(to);
  return cast;
}

/// Marks rays of parts that are not exposed, and ends them.
void RayRows::leave_out(const Half& half, const DirectionTable& table, int first, RayPacket& packet,
                        std::int32_t* ends) const {
  if (exposed_->part(half.row, half.half) == 1.0f) return;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float x = shifted(table.u[first + lane], half.shift[2]), y = shifted(table.v[first + lane], half.shift[3]);
    if (exposed_->keeps(half.row, half.half, x, y, scramble(half.random ^ std::uint64_t(first + lane)))) continue;
    ends[first + lane] = kLeftOut;
    packet.valid[lane] = 0;
  }
}

void RayRows::start_packet(const Half& half, const DirectionTable& table, int first, RayPacket& packet) const {
  Lanes dx, dy, dz, u, v;
  shift_samples(table, first, half.shift, {dx.data(), dy.data(), dz.data(), u.data(), v.data()});
  if (half.sampler) {
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfacePoint point = (*half.sampler)(u[lane], v[lane]);
      Vec3f tangent, bitangent;
      orthonormal_frame(point.normal, tangent, bitangent);
      packet.set(lane, ray_scene_.to_local(point.position) + point.normal * half.offset,
                 tangent * dx[lane] + bitangent * dy[lane] + point.normal * dz[lane]);
    }
    return;
  }
  packet.start();
  place_rays(half.quad, {dx.data(), dy.data(), dz.data(), u.data(), v.data()}, packet);
}

void RayRows::cast_half(const Half& half, const DirectionTable& table, std::int32_t* ends,
                        std::vector<TransportRows::Mirrored>& mirrored) const {
  const std::int32_t nowhere = elements_.count();
  const bool coherent = table.count() >= 128;  // measured: neighbours in a coarser table part too soon
  RayPacket packet;
  for (int first = 0; first < table.count(); first += RayPacket::kSize) {
    start_packet(half, table, first, packet);
    ray_scene_.intersect(packet, coherent);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      ends[first + lane] = hit.front ? elements_.at(hit.primitive, hit.u, hit.v) : nowhere;
    }
    if (exposed_) leave_out(half, table, first, packet, ends);
    if (has_metals_) follow_mirrors(half, first, table.count(), packet, mirrored);
  }
}

void RayRows::follow_mirrors(const Half& half, int first, int rays, RayPacket& packet,
                             std::vector<TransportRows::Mirrored>& mirrored) const {
  std::array<Color, RayPacket::kSize> throughput;
  throughput.fill(Color(1.0f));
  for (int bounce = 0; bounce < kMostMirrors; ++bounce) {
    bool going = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      packet.valid[lane] = 0;
      if (!hit.front) continue;
      Color& kept = throughput[lane];
      if (bounce > 0)
        mirrored.push_back({half.row, half.half, elements_.at(hit.primitive, hit.u, hit.v), kept / float(rays)});
      if (!metallic_[hit.primitive]) continue;
      const std::uint64_t random = scramble(half.random ^ scramble(std::uint64_t(first + lane) << 8 | bounce));
      going = go_on(scene_, ray_scene_, hit, random, lane, packet, kept) || going;
    }
    if (!going) return;
    ray_scene_.intersect(packet, false);
  }
}

}  // namespace patchlight
