#include "tracer/light/final_gather.h"

#include "pipeline/optics/lights/sky.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/mirror_path.h"
#include "tracer/sampling/pixel_samples.h"

namespace patchlight {

/// A ray on its way.
struct FinalGather::Lane {
  std::uint32_t point = 0;
  std::uint64_t random = 0;
  Color throughput{1.0f};
  bool mirrored = false;
};

/// Sums over a point's rays, W/m2.
struct FinalGather::Arrived {
  int rays = 0;
  Color direct{0.0f}, indirect{0.0f};
  std::vector<Color> of_group;  ///< [light groups], where they are told apart.
};

FinalGather::FinalGather(const PatchSet& scene, const RayScene& ray_scene, const SolvedSurfaces& surfaces,
                         const LightMixes& mixes, int rays)
    : scene_(scene),
      ray_scene_(ray_scene),
      surfaces_(surfaces),
      mixes_(mixes),
      rays_(rays),
      explicit_(scene.patches.size(), false) {
  for (const Emitter& emitter : explicit_emitters(scene))
    for (std::int32_t i = 0; i < emitter.patches; ++i) explicit_[emitter.first_patch + i] = true;
}

std::vector<FinalGather::Arrived> FinalGather::gather(std::span<const GatherPoint> points,
                                                      const TileLight::Window& window) const {
  std::vector<Arrived> arrived(points.size());
  if (mixes_.groups > 0)
    for (Arrived& at : arrived) at.of_group.assign(scene_.light_groups.size(), Color(0.0f));
  RayPacket packet;
  packet.clear();
  std::array<Lane, RayPacket::kSize> lanes;
  int lane = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const GatherPoint& point = points[i];
    const std::uint64_t seed = hash64(hash64(window.place(point.at.pixel)) + point.bounce);
    Vec3f tangent, bitangent;
    orthonormal_frame(point.at.normal, tangent, bitangent);
    for (std::uint32_t k = 0; k < std::uint32_t(rays_); ++k) {
      const std::uint32_t number = point.sample * std::uint32_t(rays_) + k;
      const Vec2f at = pixel_sample(number, seed);
      const Vec3f local = cosine_direction(at.x, at.y);
      const Vec3f direction = tangent * local.x + bitangent * local.y + point.at.normal * local.z;
      if ((direction ^ point.flat) <= 0) continue;
      ++arrived[i].rays;
      packet.set(lane, ray_scene_.to_local(point.at.position), direction);
      lanes[lane] = {i, hash64(seed ^ hash64(number))};
      if (++lane < RayPacket::kSize) continue;
      trace(packet, lanes, arrived);
      lane = 0;
    }
  }
  if (lane > 0) trace(packet, lanes, arrived);
  return arrived;
}

void FinalGather::add(std::span<const GatherPoint> points, const TileLight::Window& window, std::span<Color> pixels,
                      LayerSums* layers) const {
  const std::vector<Arrived> arrived = gather(points, window);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (arrived[i].rays == 0) continue;
    const ShadingPoint& at = points[i].at;
    const Color weight = at.weight / float(arrived[i].rays);
    pixels[at.pixel] += weight * (arrived[i].direct + arrived[i].indirect);
    if (!layers) continue;
    if (layers->light()) {
      layers->add_direct(at.pixel, at.way != ShadingPoint::Way::straight, weight * arrived[i].direct);
      layers->add_indirect(at.pixel, at.way != ShadingPoint::Way::straight, weight * arrived[i].indirect);
    }
    for (std::size_t g = 0; g < layers->group_count(); ++g)
      layers->add_of_group(g, at.pixel, weight * arrived[i].of_group[g]);
  }
}

/// Follows a packet's valid lanes to their ends. Leaves none valid.
void FinalGather::trace(RayPacket& packet, std::array<Lane, RayPacket::kSize>& lanes,
                        std::vector<Arrived>& arrived) const {
  bool going = true;
  for (int bounce = 0; going; ++bounce) {
    ray_scene_.intersect(packet, false);
    going = false;
    for (int k = 0; k < RayPacket::kSize; ++k) {
      if (packet.valid[k] == 0) continue;
      Lane& lane = lanes[k];
      const SurfaceHit hit = ray_scene_.hit(packet, k);
      packet.valid[k] = 0;
      if (hit.primitive < 0 && scene_.environment) look_up_sky(packet.direction(k), lane, arrived[lane.point]);
      if (!hit.front) continue;
      look_up(hit, lane, arrived[lane.point]);
      if (bounce >= kMostMirrors || scene_.materials[scene_.primitives[hit.primitive].material].specular == Color(0.0f))
        continue;
      lane.mirrored = true;
      lane.random = hash64(lane.random);
      going = go_on(scene_, ray_scene_, hit, lane.random, k, packet, lane.throughput) || going;
    }
  }
}

/// What of the environment is not a sun, times pi.
void FinalGather::look_up_sky(const Vec3f& direction, const Lane& lane, Arrived& arrived) const {
  const Environment& sky = *scene_.environment;
  const Color light = lane.throughput * sky.cells[sky_cell(sky, direction)] * float(kPi);
  const auto group = std::size_t(sky.light_group);
  (lane.mirrored ? arrived.indirect : arrived.direct) += light * mixes_.all[0][group];
  if (!arrived.of_group.empty()) arrived.of_group[group] += light;
}

/// What the surface at a hit sends back along the ray, times pi.
void FinalGather::look_up(const SurfaceHit& hit, const Lane& lane, Arrived& arrived) const {
  const SolvedSurfaces::Colors colors = surfaces_.colors(hit);
  DisplayLookup::Seen seen;
  const DisplayLookup::Blend blend = surfaces_.blend(hit, colors.patch, seen);
  const bool emits = lane.mirrored || !explicit_[colors.patch];
  const auto reflected = [&](std::size_t mix) {
    return lane.throughput * colors.reflectance * surfaces_.all_irradiance(hit, blend, mix);
  };
  if (emits) (lane.mirrored ? arrived.indirect : arrived.direct) += lane.throughput * surfaces_.emission(colors);
  arrived.indirect += reflected(0);
  for (std::size_t g = 0; g < arrived.of_group.size(); ++g) {
    const std::size_t mix = mixes_.groups + g;
    if (emits) arrived.of_group[g] += lane.throughput * surfaces_.emission(colors, mix);
    arrived.of_group[g] += reflected(mix);
  }
}

}  // namespace patchlight
