#include "solver/direct/photons.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/glass.h"
#include "pipeline/optics/surface/mirror.h"
#include "pipeline/optics/transport/elements.h"
#include "pipeline/optics/transport/glass_path.h"
#include "pipeline/optics/transport/mirror_path.h"

namespace patchlight {

namespace {

constexpr std::uint32_t kPilots = 64;       // pilot photons of each target
constexpr std::uint32_t kMinPhotons = 64;   // of each sample set of a target
constexpr float kUnoccludedPower = 0.02f;   // part of the unoccluded power that counts even where no pilot photon hits
constexpr float kPassedPower = 0.25f;       // of light that enters glass, which may be a plate
constexpr std::uint32_t kBatchSize = 2048;  // photons that a thread traces in one task
constexpr std::size_t kBatchesAtOnce = 64;

}  // namespace

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

/// What turned a photon so far.
struct Photons::Way {
  int turns = 0;  ///< Reflections, and glass that was no plate.
  GlassEntry entry{};
  bool has_landed = false;  ///< On the diffuse part of glass.
};

/// Sixteen photons on their ways.
struct Photons::Flight {
  RayPacket packet;
  std::array<float, RayPacket::kSize> begun{};  ///< Flux at the start, over the emitter's exitance and area.
  std::array<Color, RayPacket::kSize> left;     ///< Part of it that is left.
  std::array<Way, RayPacket::kSize> ways{};

  Color flux(int lane) const { return left[lane] * begun[lane]; }
};

/// Reflects or refracts a photon at metal or glass; false if it ends.
bool Photons::go_on(const SurfaceHit& hit, std::uint64_t random, int lane, Flight& flight) const {
  RayPacket& packet = flight.packet;
  Color& left = flight.left[lane];
  Way& way = flight.ways[lane];
  if (!is_turning(scene_, hit.primitive)) {
    ++way.turns;
    return continue_at_mirror(scene_, ray_scene_, hit, random, lane, packet, left);
  }
  const Vec3f normal = point_at(scene_.primitives[hit.primitive], hit.u, hit.v).normal;
  const float depth = hit.t * std::abs(packet.direction(lane) ^ normal);  // below the surface where it entered
  const Passing passing = cross_by_chance(scene_, ray_scene_, hit, random, lane, packet, left);
  way.has_landed = passing == Passing::lands && hit.front;
  const Material& glass = scene_.materials[scene_.primitives[hit.primitive].material];
  const bool enters = hit.front && glass.transmission.solid, rough = glass.roughness >= kMirrorRoughness;
  const bool turned = rough || (!enters && way.entry.primitive >= 0 && !is_plate(scene_, way.entry, normal, depth));
  if (passing == Passing::reflected || (passing == Passing::passed && turned)) ++way.turns;
  if (passing == Passing::passed) way.entry = enters ? GlassEntry{hit.primitive, normal} : GlassEntry{};
  return goes_on(passing) && survives_roulette(hash64(random + 3), left);
}

/// Finds the next hits beyond surfaces that let light pass straight.
void Photons::intersect(Flight& flight) const {
  ray_scene_.intersect(flight.packet, false);
  if (ray_scene_.has_passable()) pass_straight(scene_, ray_scene_, flight.packet, flight.left, false);
}

/// Starts sixteen photons of a batch and traces them to their first hit.
void Photons::start(const PhotonSource& source, const Batch& batch, std::uint32_t first, Flight& flight) const {
  flight.packet.clear();
  flight.ways = {};
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const std::uint32_t k = first + std::uint32_t(lane);
    const Vec2f from = kronecker2(k, batch.random);
    const float x = shifted((float(k) + 0.5f) / float(batch.total), uniform01(hash64(batch.random + 1)));
    const float y = shifted(radical_inverse(k), uniform01(hash64(batch.random + 2)));
    const PhotonSource::Start begin = source.start(targets_, batch.target, from, x, y);
    if (!(begin.weight > 0)) continue;
    flight.begun[lane] = begin.weight;
    flight.left[lane] = Color(1.0f);
    flight.packet.set(lane, begin.origin, begin.direction);
  }
  intersect(flight);
}

/// Estimates with a few photons the power that the metals of a target reflect, as a form factor; of an imaged mirror,
/// to other metals.
float Photons::pilot_power(const PhotonSource& source, int target) const {
  const Batch batch{target, 0, 0, kPilots, kPilots, hash64(source.random ^ hash64(~std::uint64_t(target)))};
  Flight flight;
  RayPacket& packet = flight.packet;
  float power = 0;
  const auto power_of = [&](int lane) { return max_component(flight.flux(lane)) / float(kPilots); };
  for (std::uint32_t first = 0; first < kPilots; first += RayPacket::kSize) {
    start(source, batch, first, flight);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      power += kUnoccludedPower * power_of(lane);
      packet.valid[lane] = 0;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      if (!hit.front || targets_.target_of(hit.primitive) != target) continue;
      const std::uint64_t random = hash64(batch.random ^ hash64(std::uint64_t(first + lane) << 8));
      if (go_on(hit, random, lane, flight) && !targets_.is_imaged(target))
        power += (flight.ways[lane].turns > 0 ? 1.0f : kPassedPower) * power_of(lane);
    }
    if (!targets_.is_imaged(target)) continue;
    intersect(flight);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      if (hit.front && targets_.target_of(hit.primitive) >= 0) power += power_of(lane);
    }
  }
  return power;
}

std::vector<Photons::Batch> Photons::batches(const PhotonSource& source, std::int64_t photons) const {
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

void Photons::trace(const PhotonSource& source, const Batch& batch, std::vector<Deposit>& deposits,
                    std::int64_t& cast) const {
  Flight flight;
  RayPacket& packet = flight.packet;
  for (std::uint32_t first = batch.first; first < batch.first + batch.count; first += RayPacket::kSize) {
    start(source, batch, first, flight);
    for (int bounce = 0; bounce < kMaxMirrorBounces; ++bounce) {
      bool any_active = false;
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        if (packet.valid[lane] == 0) continue;
        ++cast;
        const SurfaceHit hit = ray_scene_.hit(packet, lane);
        packet.valid[lane] = 0;
        const bool is_glass = hit.primitive >= 0 && is_turning(scene_, hit.primitive);
        if (!hit.front && !is_glass) continue;
        const Way& way = flight.ways[lane];
        const auto deposit = [&] {
          if (way.turns > (targets_.is_imaged(batch.target) ? 1 : 0))
            deposits.push_back({lookup_.patch(hit.primitive, hit.u, hit.v), flight.flux(lane)});
        };
        if (!is_glass) deposit();
        const std::int32_t target = targets_.target_of(hit.primitive);
        if (bounce > 0 ? target < 0 : target != batch.target) continue;
        const std::uint64_t random = hash64(batch.random ^ hash64(std::uint64_t(first + lane) << 8 | bounce));
        const bool active = go_on(hit, random, lane, flight);
        if (way.has_landed) deposit();
        if (!active) packet.valid[lane] = 0;
        any_active = any_active || active;
      }
      if (!any_active) break;
      intersect(flight);
    }
  }
}

std::vector<Color> Photons::shoot(const Emitter& emitter, std::int64_t photons, std::int64_t& cast) const {
  const PhotonSource source(scene_, ray_scene_, emitter, seed_);
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
