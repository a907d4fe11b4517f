#include "solver/form_factors/ray_form_factors.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/glass_path.h"

namespace patchlight {

namespace {

// Powers of the inverse of the real root of x^5 = x + 1, the best known Kronecker steps in four dimensions, times 2^64.
constexpr std::array<std::uint64_t, 4> kSteps{0xdb4f0b9175ae2165, 0xbbe0563303a4615f, 0xa0f2ec75a1fe1575,
                                              0x89e182857d9ed689};

/// Rays `first` to `last - 1` of a shot, as one task.
struct Slice {
  const Shot* shot;
  std::uint32_t first;
  std::uint32_t last;
  std::int32_t* columns;
};

constexpr std::uint32_t kSliceRays = 4096;
constexpr std::uint64_t kBatchRays = 1 << 20;

}  // namespace

RayFormFactors::RayFormFactors(const PatchSet& scene, std::uint64_t seed)
    : scene_(scene), seed_(seed), ray_scene_(scene), lookup_(scene) {}

std::vector<std::int32_t> RayFormFactors::cast(std::span<const Shot> shots) const {
  std::size_t total = 0;
  for (const Shot& shot : shots) total += shot.rays;
  std::vector<std::int32_t> columns(total);
  std::vector<Slice> slices;
  std::int32_t* next = columns.data();
  for (const Shot& shot : shots) {
    for (std::uint32_t first = 0; first < shot.rays; first += kSliceRays) {
      const std::uint32_t last = std::min(first + kSliceRays, shot.rays);
      slices.push_back({&shot, first, last, next});
      next += last - first;
    }
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, slices.size()), [&](const auto& range) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      cast_packets(*slices[i].shot, slices[i].first, slices[i].last, slices[i].columns);
  });
  return columns;
}

std::size_t RayFormFactors::batch(std::span<const Shot> shots) const {
  std::uint64_t rays = 0;
  std::size_t count = 0;
  while (count < shots.size() && (count == 0 || rays + shots[count].rays <= kBatchRays)) rays += shots[count++].rays;
  return count;
}

std::vector<std::span<const FormFactor>> RayFormFactors::rows(std::span<const Shot> shots) {
  const std::vector<std::int32_t> columns = cast(shots);
  factors_.clear();
  std::vector<std::size_t> sizes;
  const std::int32_t* next = columns.data();
  for (const Shot& shot : shots) {
    const std::size_t begin = factors_.size();
    for (const std::int32_t* last = next + shot.rays; next != last; ++next)
      if (*next >= 0) factors_.push_back({*next, 1.0f / float(shot.rays)});
    sizes.push_back(factors_.size() - begin);
  }
  std::vector<std::span<const FormFactor>> result;
  std::size_t begin = 0;
  for (const std::size_t size : sizes) {
    result.push_back(std::span(factors_).subspan(begin, size));
    begin += size;
  }
  return result;
}

void RayFormFactors::cast_packets(const Shot& shot, std::uint32_t first, std::uint32_t last,
                                  std::int32_t* columns) const {
  const Patch& patch = scene_.patches[shot.patch];
  const PatchSampler sampler(scene_.primitives, patch);
  const float offset = ray_scene_.offset(patch.primitive);
  const bool has_mask = has_alpha_mask(scene_, patch);
  std::array<std::uint64_t, 4> x;
  for (std::uint64_t k = 0; k < 4; ++k)
    x[k] = hash64(seed_ ^ hash64(4 * std::uint64_t(shot.patch) + k)) + kSteps[k] * (shot.skip + first);

  RayPacket packet;
  packet.clear();
  for (std::uint32_t begin = first; begin < last; begin += RayPacket::kSize) {
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      Vec2f uv(uniform01(x[0]), uniform01(x[1]));
      if (has_mask) uv = covered_point(scene_, patch, sampler, uv, hash64(x[0] ^ hash64(x[1])));
      const SurfacePoint point = sampler(uv.x, uv.y);
      const Vec3f local = cosine_direction(uniform01(x[2]), uniform01(x[3]));
      Vec3f tangent, bitangent;
      orthonormal_frame(point.normal, tangent, bitangent);
      packet.set(lane, ray_scene_.to_local(point.position) + point.normal * offset,
                 tangent * local.x + bitangent * local.y + point.normal * local.z);
      for (std::size_t k = 0; k < 4; ++k) x[k] += kSteps[k];
    }
    ray_scene_.intersect(packet, false);
    if (ray_scene_.has_passable()) pass_straight(scene_, ray_scene_, packet, {}, true);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      *columns++ = hit.front ? lookup_.patch(hit.primitive, hit.u, hit.v) : -1;
    }
  }
}

}  // namespace patchlight
