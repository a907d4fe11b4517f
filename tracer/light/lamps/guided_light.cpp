#include "tracer/light/lamps/guided_light.h"

#include "pipeline/optics/sampling/random.h"
#include "tracer/light/lamps/lamp_samples.h"

namespace patchlight {

namespace {

constexpr int kSweeps = 6;        // over the tile, to and fro, in which clusters learn from their neighbours
constexpr int kUniformRays = 16;  // that may find what no neighbour has seen

}  // namespace

/// What the cluster and its neighbours saw, and the cells beside it.
VisibleCells GuidedLight::around(std::size_t cluster) const {
  VisibleCells cells;
  for (const std::int32_t s : clusters_.neighbours()[cluster])
    if (s >= 0 && sees_[s]) cells.add_with_border(seen_[s]);
  return cells;
}

/// Casts `count` shadow rays, a multiple of 16, from a cluster to the lamp. Calls act(place, weight) for each ray that
/// reaches the lamp: its place in the unit square of the lamp's samples, and its form factor.
template <class Act>
void GuidedLight::cast(std::size_t cluster, const CellSampler* guide, int count, std::uint64_t seed, Act act) const {
  const std::span<const ShadingPoint> points = clusters_[cluster].points;
  for (int first = 0; first < count; first += RayPacket::kSize) {
    RayPacket packet;
    packet.clear();
    std::array<Vec2f, RayPacket::kSize> at;
    std::array<float, RayPacket::kSize> weights{};
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const ShadingPoint& point = points[std::size_t(lane) * points.size() / RayPacket::kSize];
      at[lane] = kronecker2(std::uint64_t(first + lane), seed);
      if (guide) at[lane] = (*guide)(at[lane]);
      const DirectLight::Sample sample =
          light_.view(point.position, point.normal, kFarLamp).sample(at[lane].x, at[lane].y);
      weights[lane] = sample.weight;
      if (sample.weight > 0)
        packet.set_shadow(lane, ray_scene_.to_local(point.position), sample.direction, sample.distance);
    }
    const std::uint32_t occluded = ray_scene_.occluded(packet);
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      if (weights[lane] > 0 && !(occluded >> lane & 1u)) act(at[lane], weights[lane]);
  }
}

std::vector<GuidedLight::Factor> GuidedLight::factors(std::span<const std::uint32_t> listed, int rays,
                                                      std::uint64_t seed) {
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t k = 0; k < listed.size(); ++k) {
      const std::size_t s = listed[sweep % 2 == 0 ? k : listed.size() - 1 - k];
      if (!is_found(s)) continue;
      const CellSampler guide(around(s));
      cast(s, &guide, RayPacket::kSize, hash64(seed ^ hash64(kSweeps * s + std::size_t(sweep))),
           [&](const Vec2f& at, float) { add(s, at); });
    }
  std::vector<Factor> factors;
  const int guided_rays = (std::max(rays, 1) + RayPacket::kSize - 1) / RayPacket::kSize * RayPacket::kSize;
  for (const std::uint32_t s : listed) {
    Factor& factor = factors.emplace_back();
    factor.found = is_found(s);
    if (!factor.found) continue;
    const VisibleCells guide = around(s);
    const CellSampler sampler(guide);
    const double inside = kUniformRays + guided_rays / double(sampler.area());
    const auto add = [&](const Vec2f& at, float weight) {
      if (guide.contains(at))
        factor.guided += weight / inside;
      else
        factor.rest += double(weight) / kUniformRays;
    };
    cast(s, nullptr, kUniformRays, hash64(~seed ^ hash64(2 * std::uint64_t(s))), add);
    cast(s, &sampler, guided_rays, hash64(~seed ^ hash64(2 * std::uint64_t(s) + 1)), add);
  }
  return factors;
}

}  // namespace patchlight
