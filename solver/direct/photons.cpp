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
#include "pipeline/optics/transport/glass_path.h"
#include "pipeline/optics/transport/mirror_path.h"

namespace patchlight {

namespace {

constexpr std::uint32_t kPilots = 64;       // pilot photons of each target
constexpr std::uint32_t kMinPhotons = 64;   // of each sample set of a target
constexpr float kUnoccludedPower = 0.02f;   // part of the unoccluded power that counts even where no pilot photon hits
constexpr std::uint32_t kBatchSize = 2048;  // photons that a thread traces in one task
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
      surface_patch_ = emitter.patches == 1 ? first : sub_patch(scene, first, 0, 0, 1, 1);
      sampler_.emplace(scene.primitives, surface_patch_);
      return;
    }
    light_ = scene.lights[emitter.light];
    direct_light_.emplace(scene, ray_scene, emitter);
    for (const Patch& patch : scene.patches)
      scene_start_ = std::min(scene_start_, (patch.center ^ light_.direction) - std::sqrt(patch.area) * kPatchSizes);
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  struct Start {
    Vec3f origin{0.0f};  ///< In the local frame.
    Vec3f direction{0.0f};
    float weight = 0.0f;  ///< Flux for an exitance of 1 over the emitter's area, or for a light's strength of 1.
  };

  /// (x,y): in the unit square, for the direction. `from`: in the unit square, for the origin unless it is a point.
  Start start(const PhotonTargets& targets, int target, const Vec2f& from, float x, float y) const {
    if (surface_) {
      const SurfacePoint point = (*sampler_)(from.x, from.y);
      const PhotonTargets::Aim aim = targets.aim(target, point, x, y);
      return {ray_scene_.to_local(point.position) + point.normal * offset_, aim.direction, aim.weight};
    }
    if (light_.kind == Light::Kind::sun) {
      // From a disk as large as the target, placed before the whole scene as the sun sees it.
      const auto [center, radius] = targets.bounding_sphere(target);
      Vec3f tangent, bitangent;
      orthonormal_frame(Vec3f(light_.direction), tangent, bitangent);
      const double r = radius * std::sqrt(from.x), turn = 2 * kPi * from.y;
      Vec3d origin = center + Vec3d(tangent) * (r * std::cos(turn)) + Vec3d(bitangent) * (r * std::sin(turn));
      origin += light_.direction * (scene_start_ - (origin ^ light_.direction));
      return {ray_scene_.to_local(origin), Vec3f(light_.direction), float(kPi * radius * radius)};
    }
    if (light_.radius > 0) return start_on_ball(targets, target, from, x, y);
    const PhotonTargets::Aim aim = targets.aim(target, light_.position, x, y);
    const double strength = direct_light_->perpendicular_factor(light_.position + Vec3d(aim.direction));
    return {ray_scene_.to_local(light_.position), aim.direction, float(aim.weight * strength)};
  }

  const std::uint64_t random;
  const double area;

 private:
  /// From the surface of a light with a radius.
  Start start_on_ball(const PhotonTargets& targets, int target, const Vec2f& from, float x, float y) const {
    const double z = 1 - 2 * double(from.x), sine = std::sqrt(std::max(0.0, 1 - z * z)), turn = 2 * kPi * from.y;
    const Vec3d normal(sine * std::cos(turn), sine * std::sin(turn), z);
    const Vec3d origin = light_.position + normal * light_.radius;
    const PhotonTargets::Aim aim = targets.aim(target, SurfacePoint{origin, Vec3f(normal)}, x, y);
    if (!(aim.weight > 0)) return {};
    const double part = direct_light_->relative_intensity(Vec3d(aim.direction));
    return {ray_scene_.to_local(origin), aim.direction, float(4 * kPi * double(aim.weight) * part)};
  }

  static constexpr double kPatchSizes = 1e3;  // bounds the extent of a patch, slivers included

  const RayScene& ray_scene_;
  const bool surface_;
  const float offset_;
  Patch surface_patch_;  ///< The union of the emitter's patches.
  std::optional<PatchSampler> sampler_;
  Light light_;
  std::optional<DirectLight> direct_light_;
  double scene_start_ = std::numeric_limits<double>::max();  ///< Lower bound along a sun's direction, m.
};

/// Photons `first` to `first + count - 1` of the `total` that a sample set (0 or 1) aims at a target.
struct Photons::Batch {
  int target, sample_set;
  std::uint32_t first, count, total;
  std::uint64_t random;
};

struct Photons::Deposit {
  std::int32_t patch;
  Color flux;
};

Photons::Photons(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed,
                 std::span<const PlaneMirror> imaged)
    : scene_(scene),
      ray_scene_(ray_scene),
      lookup_(scene),
      targets_(scene, ray_scene, imaged),
      has_paths_(has_paths(imaged)),
      seed_(hash64(~seed)) {}

bool Photons::has_paths(std::span<const PlaneMirror> imaged) const {
  if (targets_.count() > int(imaged.size())) return true;
  const auto sees = [&](const PlaneMirror& a, const PlaneMirror& b) {
    return !a.is_behind(scene_.primitives[b.primitive()].corners);
  };
  for (const PlaneMirror& a : imaged)
    for (const PlaneMirror& b : imaged)
      if (sees(a, b) && sees(b, a)) return true;
  return false;
}

/// Finds the next hits beyond surfaces that let light pass straight.
void Photons::intersect(RayPacket& packet, std::span<Color> flux) const {
  ray_scene_.intersect(packet, false);
  if (ray_scene_.has_passable()) pass_straight(scene_, ray_scene_, packet, flux);
}

/// Starts sixteen photons of a batch and traces them to their first hit.
void Photons::start(const Source& source, const Batch& batch, std::uint32_t first, RayPacket& packet,
                    std::span<Color> flux) const {
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const std::uint32_t k = first + std::uint32_t(lane);
    const Vec2f from = kronecker2(k, batch.random);
    const float x = shifted((float(k) + 0.5f) / float(batch.total), uniform01(hash64(batch.random + 1)));
    const float y = shifted(radical_inverse(k), uniform01(hash64(batch.random + 2)));
    const Source::Start begin = source.start(targets_, batch.target, from, x, y);
    if (!(begin.weight > 0)) continue;
    flux[lane] = Color(begin.weight);
    packet.set(lane, begin.origin, begin.direction);
  }
  intersect(packet, flux);
}

/// Estimates with a few photons the power that the metals of a target reflect, as a form factor; of an imaged mirror,
/// to other metals.
float Photons::pilot_power(const Source& source, int target) const {
  const Batch batch{target, 0, 0, kPilots, kPilots, hash64(source.random ^ hash64(~std::uint64_t(target)))};
  RayPacket packet;
  std::array<Color, RayPacket::kSize> flux;
  float power = 0;
  const auto power_of = [&](int lane) { return std::max({flux[lane].x, flux[lane].y, flux[lane].z}) / float(kPilots); };
  for (std::uint32_t first = 0; first < kPilots; first += RayPacket::kSize) {
    start(source, batch, first, packet, flux);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      power += kUnoccludedPower * power_of(lane);
      packet.valid[lane] = 0;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      if (!hit.front || targets_.target_of(hit.primitive) != target) continue;
      const std::uint64_t random = hash64(batch.random ^ hash64(std::uint64_t(first + lane) << 8));
      if (continue_at_mirror(scene_, ray_scene_, hit, random, lane, packet, flux[lane]) && !targets_.is_imaged(target))
        power += power_of(lane);
    }
    if (!targets_.is_imaged(target)) continue;
    intersect(packet, flux);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      if (hit.front && targets_.target_of(hit.primitive) >= 0) power += power_of(lane);
    }
  }
  return power;
}

std::vector<Photons::Batch> Photons::batches(const Source& source, std::int64_t photons) const {
  std::vector<float> powers(targets_.count());
  tbb::parallel_for(0, targets_.count(), [&](int target) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    powers[target] = pilot_power(source, target);
  });
  double sum = 0;
  for (const float power : powers) sum += power;
  std::vector<Batch> result;
  for (int target = 0; target < targets_.count(); ++target) {
    const double share = sum > 0 ? powers[target] / sum : 0.0;
    const std::uint32_t total = std::max(kMinPhotons, std::uint32_t(0.5 * share * double(photons)) / 16 * 16);
    for (int sample_set = 0; sample_set < 2; ++sample_set) {
      const std::uint64_t random = hash64(source.random ^ hash64(2 * std::uint64_t(target) + sample_set));
      for (std::uint32_t first = 0; first < total; first += kBatchSize)
        result.push_back({target, sample_set, first, std::min(kBatchSize, total - first), total, random});
    }
  }
  return result;
}

void Photons::trace(const Source& source, const Batch& batch, std::vector<Deposit>& deposits,
                    std::int64_t& cast) const {
  RayPacket packet;
  std::array<Color, RayPacket::kSize> flux;
  for (std::uint32_t first = batch.first; first < batch.first + batch.count; first += RayPacket::kSize) {
    start(source, batch, first, packet, flux);
    for (int bounce = 0; bounce < kMaxMirrorBounces; ++bounce) {
      bool any_active = false;
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        if (packet.valid[lane] == 0) continue;
        ++cast;
        const SurfaceHit hit = ray_scene_.hit(packet, lane);
        packet.valid[lane] = 0;
        if (!hit.front) continue;
        if (bounce > (targets_.is_imaged(batch.target) ? 1 : 0))
          deposits.push_back({lookup_.patch(hit.primitive, hit.u, hit.v), flux[lane]});
        const std::int32_t metal = targets_.target_of(hit.primitive);
        if (bounce > 0 ? metal < 0 : metal != batch.target) continue;
        const std::uint64_t random = hash64(batch.random ^ hash64(std::uint64_t(first + lane) << 8 | bounce));
        any_active = continue_at_mirror(scene_, ray_scene_, hit, random, lane, packet, flux[lane]) || any_active;
      }
      if (!any_active) break;
      intersect(packet, flux);
    }
  }
}

std::vector<Color> Photons::shoot(const Emitter& emitter, std::int64_t photons, std::int64_t& cast) const {
  const Source source(scene_, ray_scene_, emitter, seed_);
  const std::vector<Batch> pending = batches(source, photons);
  cast += std::int64_t(kPilots) * targets_.count();
  std::vector<Vec3d> sums(2 * scene_.patches.size(), Vec3d(0.0));
  for (std::size_t done = 0; done < pending.size(); done += kBatchesAtOnce) {
    std::vector<std::vector<Deposit>> deposits(std::min(kBatchesAtOnce, pending.size() - done));
    std::vector<std::int64_t> rays(deposits.size());
    tbb::parallel_for(std::size_t(0), deposits.size(), [&](std::size_t k) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
      trace(source, pending[done + k], deposits[k], rays[k]);
    });
    for (std::size_t k = 0; k < deposits.size(); ++k) {
      const Batch& batch = pending[done + k];
      for (const Deposit& deposit : deposits[k])
        sums[2 * deposit.patch + batch.sample_set] += Vec3d(deposit.flux) / double(batch.total);
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
