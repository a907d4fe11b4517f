#include "solver/direct/photons.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/elements.h"
#include "pipeline/optics/transport/mirror_path.h"

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
      : random(hash64(seed ^ hash64(std::uint64_t(emitter.first_patch + emitter.light + 1)))),
        area(emitter.light < 0 ? emitter.area : 1.0),
        ray_scene_(ray_scene),
        surface_(emitter.light < 0),
        offset_(surface_ ? ray_scene.offset(emitter.primitive) : 0.0f) {
    if (surface_) {
      const Patch& first = scene.patches[emitter.first_patch];
      const Patch& last = scene.patches[emitter.first_patch + emitter.patches - 1];
      whole_ = part_of(scene, first, first.u0, first.v0, last.u1, last.v1);
      sampler_.emplace(scene.primitives[emitter.primitive], whole_);
      return;
    }
    light_ = scene.lights[emitter.light];
    glow_.emplace(light_);
    for (const Patch& patch : scene.patches)
      behind_ = std::min(behind_, (patch.center ^ light_.direction) - std::sqrt(patch.area) * kBehind);
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  struct Start {
    Vec3f origin{0.0f};  ///< In the local frame.
    Vec3f direction{0.0f};
    float weight = 0.0f;  ///< Flux, for an exitance over the area of 1, or a strength of 1.
  };

  /// For (x,y) of the unit square; `from`: of another, that surfaces and suns take.
  Start start(const PhotonTargets& targets, int target, const Vec2f& from, float x, float y) const {
    if (surface_) {
      const SurfacePoint point = (*sampler_)(from.x, from.y);
      const PhotonTargets::Aim aim = targets.aim(target, point, x, y);
      return {ray_scene_.to_local(point.position) + point.normal * offset_, aim.direction, aim.weight};
    }
    if (light_.kind == Light::Kind::sun) {
      // From a disk as large as the target, behind all of the scene.
      const auto [center, radius] = targets.ball(target);
      Vec3f tangent, bitangent;
      orthonormal_frame(Vec3f(light_.direction), tangent, bitangent);
      const double r = radius * std::sqrt(from.x), turn = 2 * kPi * from.y;
      Vec3d origin = center + Vec3d(tangent) * (r * std::cos(turn)) + Vec3d(bitangent) * (r * std::sin(turn));
      origin += light_.direction * (behind_ - (origin ^ light_.direction));
      return {ray_scene_.to_local(origin), Vec3f(light_.direction), float(kPi * radius * radius)};
    }
    const PhotonTargets::Aim aim = targets.aim(target, light_.position, x, y);
    const double strength = glow_->perpendicular_factor(light_.position + Vec3d(aim.direction));
    return {ray_scene_.to_local(light_.position), aim.direction, float(aim.weight * strength)};
  }

  const std::uint64_t random;
  const double area;

 private:
  static constexpr double kBehind = 1e3;  // sizes of a patch: even slivers lie before that

  const RayScene& ray_scene_;
  const bool surface_;
  const float offset_;
  Patch whole_;
  std::optional<PatchSampler> sampler_;
  Light light_;
  std::optional<DirectLight> glow_;
  double behind_ = std::numeric_limits<double>::max();  ///< Along a sun's direction, m.
};

/// Photons `first` and following of those that half 0 or 1 of the samples aims at a target.
struct Photons::Batch {
  int target, sample_set;
  std::uint32_t first, count, all;
  std::uint64_t random;
};

struct Photons::Landed {
  std::int32_t patch;
  Color carried;
};

Photons::Photons(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed)
    : scene_(scene), ray_scene_(ray_scene), lookup_(scene), targets_(scene, ray_scene), seed_(hash64(~seed)) {}

/// Starts sixteen photons of a batch and casts them as far as they first get.
void Photons::start(const Source& source, const Batch& batch, std::uint32_t first, RayPacket& packet,
                    std::span<Color> carried) const {
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const std::uint32_t k = first + std::uint32_t(lane);
    const Vec2f from = kronecker2(k, batch.random);
    const float x = shifted((float(k) + 0.5f) / float(batch.all), uniform01(hash64(batch.random + 1)));
    const float y = shifted(radical_inverse(k), uniform01(hash64(batch.random + 2)));
    const Source::Start begin = source.start(targets_, batch.target, from, x, y);
    if (!(begin.weight > 0)) continue;
    carried[lane] = Color(begin.weight);
    packet.set(lane, begin.origin, begin.direction);
  }
  ray_scene_.intersect(packet, false);
}

/// What metals of a target reflect of an emitter's light, as a form factor, by a few photons.
float Photons::pilot_power(const Source& source, int target) const {
  const Batch batch{target, 0, 0, kPilots, kPilots, hash64(source.random ^ hash64(~std::uint64_t(target)))};
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
    for (int sample_set = 0; sample_set < 2; ++sample_set) {
      const std::uint64_t random = hash64(source.random ^ hash64(2 * std::uint64_t(target) + sample_set));
      for (std::uint32_t first = 0; first < all; first += kBatch)
        result.push_back({target, sample_set, first, std::min(kBatch, all - first), all, random});
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
        const std::uint64_t random = hash64(batch.random ^ hash64(std::uint64_t(first + lane) << 8 | bounce));
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
        sums[2 * photon.patch + batch.sample_set] += Vec3d(photon.carried) / double(batch.all);
      cast += rays[k];
    }
    Progress::check_interrupted();
  }
  std::vector<Color> factors;
  factors.reserve(sums.size());
  for (std::size_t k = 0; k < sums.size(); ++k)
    factors.emplace_back(Vec3f(sums[k] * (source.area / scene_.patches[k / 2].covered_area())));
  return factors;
}

}  // namespace patchlight
