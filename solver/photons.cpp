#include "solver/photons.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>

#include "pipeline/optics/elements.h"
#include "pipeline/optics/mirror_path.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"

namespace patchlight {

namespace {

constexpr std::uint32_t kPilots = 64;   // for each target
constexpr std::uint32_t kLeast = 64;    // photons for each half of a target
constexpr float kUnseen = 0.02f;        // of the photons that targets would get if nothing stood before them
constexpr std::uint32_t kBatch = 2048;  // photons that a thread traces at a time
constexpr std::size_t kBatchesAtOnce = 64;

}  // namespace

/// Where an emitter's photons start.
class Photons::Source {
 public:
  Source(const PatchSet& scene, const RayScene& ray_scene, const Emitter& emitter, std::uint64_t seed)
      : random(scramble(seed ^ scramble(std::uint64_t(emitter.first_patch)))),
        area(emitter.area),
        offset(ray_scene.offset(emitter.primitive)),
        whole_(whole(scene, emitter)),
        sampler_(scene.primitives[emitter.primitive], whole_) {}
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  SurfacePoint point(float x, float y) const { return sampler_(x, y); }

  const std::uint64_t random;
  const double area;
  const float offset;

 private:
  static Patch whole(const PatchSet& scene, const Emitter& emitter) {
    const Patch& first = scene.patches[emitter.first_patch];
    const Patch& last = scene.patches[emitter.first_patch + emitter.patches - 1];
    return part_of(scene, first, first.u0, first.v0, last.u1, last.v1);
  }

  const Patch whole_;
  const PatchSampler sampler_;
};

/// Photons `first` and following of those that half 0 or 1 of the samples aims at a target.
struct Photons::Batch {
  int target, half;
  std::uint32_t first, count, all;
  std::uint64_t random;
};

struct Photons::Landed {
  std::int32_t patch;
  Color carried;
};

Photons::Photons(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed)
    : scene_(scene), ray_scene_(ray_scene), lookup_(scene), targets_(scene, ray_scene), seed_(scramble(~seed)) {}

/// Starts sixteen photons of a batch and casts them as far as they first get.
void Photons::start(const Source& source, const Batch& batch, std::uint32_t first, RayPacket& packet,
                    std::span<Color> carried) const {
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const std::uint32_t k = first + std::uint32_t(lane);
    const Vec2f from = kronecker2(k, batch.random);
    const float x = shifted((float(k) + 0.5f) / float(batch.all), to_unit(scramble(batch.random + 1)));
    const float y = shifted(radical_inverse(k), to_unit(scramble(batch.random + 2)));
    const SurfacePoint point = source.point(from.x, from.y);
    const PhotonTargets::Aim aim = targets_.aim(batch.target, point, x, y);
    if (!(aim.weight > 0)) continue;
    carried[lane] = Color(aim.weight);
    packet.set(lane, ray_scene_.to_local(point.position) + point.normal * source.offset, aim.direction);
  }
  ray_scene_.intersect(packet, false);
}

/// What metals of a target reflect of an emitter's light, as a form factor, by a few photons.
float Photons::pilot_power(const Source& source, int target) const {
  const Batch batch{target, 0, 0, kPilots, kPilots, scramble(source.random ^ scramble(~std::uint64_t(target)))};
  RayPacket packet;
  std::array<Color, RayPacket::kSize> carried;
  float power = 0;
  for (std::uint32_t first = 0; first < kPilots; first += RayPacket::kSize) {
    start(source, batch, first, packet, carried);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      power += kUnseen * carried[lane].x / float(kPilots);
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      if (!hit.front || targets_.of(hit.primitive) != target) continue;
      const Color& specular = scene_.materials[scene_.primitives[hit.primitive].material].specular;
      power += std::max({specular.x, specular.y, specular.z}) * carried[lane].x / float(kPilots);
    }
  }
  return power;
}

std::vector<Photons::Batch> Photons::batches(const Source& source, std::int64_t photons) const {
  std::vector<float> powers(targets_.count());
  tbb::parallel_for(0, targets_.count(), [&](int target) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
    powers[target] = pilot_power(source, target);
  });
  double sum = 0;
  for (const float power : powers) sum += power;
  std::vector<Batch> result;
  for (int target = 0; target < targets_.count(); ++target) {
    const double share = sum > 0 ? powers[target] / sum : 0.0;
    const std::uint32_t all = std::max(kLeast, std::uint32_t(0.5 * share * double(photons)) / 16 * 16);
    for (int half = 0; half < 2; ++half) {
      const std::uint64_t random = scramble(source.random ^ scramble(2 * std::uint64_t(target) + half));
      for (std::uint32_t first = 0; first < all; first += kBatch)
        result.push_back({target, half, first, std::min(kBatch, all - first), all, random});
    }
  }
  return result;
}

void Photons::trace(const Source& source, const Batch& batch, std::vector<Landed>& landed, std::int64_t& cast) const {
  RayPacket packet;
  std::array<Color, RayPacket::kSize> carried;
  for (std::uint32_t first = batch.first; first < batch.first + batch.count; first += RayPacket::kSize) {
    start(source, batch, first, packet, carried);
    for (int bounce = 0; bounce < kMostMirrors; ++bounce) {
      bool going = false;
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        if (packet.valid[lane] == 0) continue;
        ++cast;
        const SurfaceHit hit = ray_scene_.hit(packet, lane);
        packet.valid[lane] = 0;
        if (!hit.front) continue;
        if (bounce > 0) landed.push_back({lookup_.patch(hit.primitive, hit.u, hit.v), carried[lane]});
        const std::int32_t metal = targets_.of(hit.primitive);
        if (bounce > 0 ? metal < 0 : metal != batch.target) continue;
        const std::uint64_t random = scramble(batch.random ^ scramble(std::uint64_t(first + lane) << 8 | bounce));
        going = go_on(scene_, ray_scene_, hit, random, lane, packet, carried[lane]) || going;
      }
      if (!going) break;
      ray_scene_.intersect(packet, false);
    }
  }
}

std::vector<Color> Photons::shoot(const Emitter& emitter, std::int64_t photons, std::int64_t& cast) const {
  const Source source(scene_, ray_scene_, emitter, seed_);
  const std::vector<Batch> all = batches(source, photons);
  cast += std::int64_t(kPilots) * targets_.count();
  std::vector<Vec3d> sums(2 * scene_.patches.size(), Vec3d(0.0));
  for (std::size_t done = 0; done < all.size(); done += kBatchesAtOnce) {
    std::vector<std::vector<Landed>> landed(std::min(kBatchesAtOnce, all.size() - done));
    std::vector<std::int64_t> rays(landed.size());
    tbb::parallel_for(std::size_t(0), landed.size(), [&](std::size_t k) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      trace(source, all[done + k], landed[k], rays[k]);
    });
    for (std::size_t k = 0; k < landed.size(); ++k) {
      const Batch& batch = all[done + k];
      for (const Landed& photon : landed[k])
        sums[2 * photon.patch + batch.half] += Vec3d(photon.carried) / double(batch.all);
      cast += rays[k];
    }
    Progress::check_interrupted();
  }
  std::vector<Color> factors;
  factors.reserve(sums.size());
  for (std::size_t k = 0; k < sums.size(); ++k)
    factors.emplace_back(Vec3f(sums[k] * (source.area / scene_.patches[k / 2].area)));
  return factors;
}

}  // namespace patchlight
