#include "tracer/light/final_gather.h"

#include "pipeline/optics/lights/sky.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/glass_path.h"
#include "pipeline/optics/transport/mirror_path.h"
#include "tracer/sampling/pixel_samples.h"

namespace patchlight {

/// State of a lane's ray.
struct FinalGather::GatherRay {
  std::uint32_t point = 0;
  std::uint64_t random = 0;
  Color throughput{1.0f};
  bool mirrored = false;
};

/// Sums over the rays of a point, W/m2.
struct FinalGather::Gathered {
  int rays = 0;
  Color direct{0.0f}, indirect{0.0f};
  std::vector<Color> by_group;  ///< [light groups]; empty: not asked for.
};

FinalGather::FinalGather(const PatchSet& scene, const RayScene& ray_scene, const SolvedSurfaces& surfaces,
                         const LightMixes& mixes, int rays)
    : scene_(scene),
      ray_scene_(ray_scene),
      surfaces_(surfaces),
      mixes_(mixes),
      rays_(rays),
      coats_(scene),
      sampled_(scene.patches.size(), false) {
  for (const auto& emitters : {explicit_emitters(scene), further_emitters(scene)})
    for (const Emitter& emitter : emitters)
      for (std::int32_t i = 0; i < emitter.patches; ++i) sampled_[emitter.first_patch + i] = true;
}

std::vector<FinalGather::Gathered> FinalGather::gather(std::span<const GatherPoint> points,
                                                       const TileWindow& window) const {
  std::vector<Gathered> gathered(points.size());
  if (mixes_.first_group > 0)
    for (Gathered& sums : gathered) sums.by_group.assign(scene_.light_groups.size(), Color(0.0f));
  RayPacket packet;
  packet.clear();
  std::array<GatherRay, RayPacket::kSize> rays;
  int lane = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const GatherPoint& point = points[i];
    const std::uint64_t seed = hash64(hash64(window.pixel_id(point.shading.pixel)) + point.bounce);
    Vec3f tangent, bitangent;
    orthonormal_frame(point.shading.normal, tangent, bitangent);
    for (std::uint32_t k = 0; k < std::uint32_t(rays_); ++k) {
      const std::uint32_t index = point.sample * std::uint32_t(rays_) + k;
      const Vec2f at = pixel_sample(index, seed);
      const Vec3f local = cosine_direction(at.x, at.y);
      const Vec3f direction = tangent * local.x + bitangent * local.y + point.shading.normal * local.z;
      if ((direction ^ point.geometric_normal) <= 0) continue;
      ++gathered[i].rays;
      packet.set(lane, ray_scene_.to_local(point.shading.position), direction);
      rays[lane] = {i, hash64(seed ^ hash64(index))};
      if (++lane < RayPacket::kSize) continue;
      trace(packet, rays, gathered);
      lane = 0;
    }
  }
  if (lane > 0) trace(packet, rays, gathered);
  return gathered;
}

void FinalGather::add(std::span<const GatherPoint> points, const TileWindow& window, std::span<Color> pixels,
                      LayerSums* layers) const {
  const std::vector<Gathered> gathered = gather(points, window);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (gathered[i].rays == 0) continue;
    const ShadingPoint& point = points[i].shading;
    const Color weight = point.weight / float(gathered[i].rays);
    pixels[point.pixel] += weight * (gathered[i].direct + gathered[i].indirect);
    if (!layers) continue;
    if (layers->has_light()) {
      layers->add_direct(point.pixel, point.seen_by, weight * gathered[i].direct);
      layers->add_indirect(point.pixel, point.seen_by, weight * gathered[i].indirect);
    }
    for (std::size_t g = 0; g < layers->group_count(); ++g)
      layers->add_to_group(g, point.pixel, weight * gathered[i].by_group[g]);
  }
}

/// Traces a packet's valid lanes to their ends. Leaves none valid.
void FinalGather::trace(RayPacket& packet, std::array<GatherRay, RayPacket::kSize>& rays,
                        std::vector<Gathered>& gathered) const {
  bool active = true;
  for (int bounce = 0; active; ++bounce) {
    ray_scene_.intersect(packet, false);
    active = false;
    for (int k = 0; k < RayPacket::kSize; ++k) {
      if (packet.valid[k] == 0) continue;
      GatherRay& ray = rays[k];
      const SurfaceHit hit = ray_scene_.hit(packet, k);
      packet.valid[k] = 0;
      if (hit.primitive < 0 && scene_.environment) add_sky(packet.direction(k), ray, gathered[ray.point]);
      if (packet.passable >> k & 1u) {
        active = (bounce < kMaxMirrorBounces && pass(hit, k, packet, ray, gathered[ray.point])) || active;
        continue;
      }
      if (!hit.front) continue;
      add_surface(hit, packet.direction(k), ray, gathered[ray.point]);
      if (bounce >= kMaxMirrorBounces || !is_specular(scene_.materials[scene_.primitives[hit.primitive].material]))
        continue;
      ray.mirrored = true;
      ray.random = hash64(ray.random);
      active = continue_at_mirror(scene_, ray_scene_, hit, ray.random, k, packet, ray.throughput) || active;
    }
  }
}

/// Adds the radiance of a surface that lets light pass, and goes on by chance; false if the ray ends.
bool FinalGather::pass(const SurfaceHit& hit, int lane, RayPacket& packet, GatherRay& ray, Gathered& gathered) const {
  const GatherRay before = ray;
  const Vec3f direction = packet.direction(lane);
  ray.random = hash64(ray.random);
  const Passing passing = cross_by_chance(scene_, ray_scene_, hit, ray.random, lane, packet, ray.throughput);
  if (passing == Passing::open) return true;
  if (hit.front) add_surface(hit, direction, before, gathered);
  ray.mirrored = ray.mirrored || passing == Passing::reflected;
  if (!goes_on(passing)) packet.valid[lane] = 0;
  return goes_on(passing);
}

/// Adds the environment without suns, times pi.
void FinalGather::add_sky(const Vec3f& direction, const GatherRay& ray, Gathered& gathered) const {
  const Environment& sky = *scene_.environment;
  const Color light = ray.throughput * sky.cells[sky_cell(sky, direction)] * float(kPi);
  const auto group = std::size_t(sky.light_group);
  (ray.mirrored ? gathered.indirect : gathered.direct) += light * mixes_.all[0][group];
  if (!gathered.by_group.empty()) gathered.by_group[group] += light;
}

/// Adds the radiance of the surface at a hit, times pi.
void FinalGather::add_surface(const SurfaceHit& hit, const Vec3f& direction, const GatherRay& ray,
                              Gathered& gathered) const {
  SolvedSurfaces::Colors colors = surfaces_.colors(hit);
  const Primitive& primitive = scene_.primitives[hit.primitive];
  Color passing(1.0f);  // through the coat
  if (scene_.materials[primitive.material].is_coated()) {
    const SpecularProperties specular = specular_properties_at(scene_, hit.primitive, hit.u, hit.v);
    const float cosine = -(direction ^ point_at(primitive, hit.u, hit.v).normal);
    passing -= coats_.at(specular, cosine);
    colors.reflectance *= passing;
  }
  const DisplayLookup::Blend blend = surfaces_.blend(hit, colors.patch);
  const bool emits = ray.mirrored || !sampled_[colors.patch];
  const auto reflected = [&](std::size_t mix) {
    Color light = ray.throughput * colors.reflectance * surfaces_.total_irradiance(hit, blend, mix);
    if (is_translucent(scene_, primitive)) {
      const SurfaceHit behind = surfaces_.behind(hit);
      const SolvedSurfaces::Colors passed = surfaces_.passed_colors(behind);
      light += ray.throughput * passing * passed.reflectance *
               surfaces_.total_irradiance(behind, surfaces_.blend(behind, passed.patch), mix);
    }
    return light;
  };
  if (emits) (ray.mirrored ? gathered.indirect : gathered.direct) += ray.throughput * surfaces_.emission(colors);
  gathered.indirect += reflected(0);
  for (std::size_t g = 0; g < gathered.by_group.size(); ++g) {
    const std::size_t mix = mixes_.first_group + g;
    if (emits) gathered.by_group[g] += ray.throughput * surfaces_.emission(colors, mix);
    gathered.by_group[g] += reflected(mix);
  }
}

}  // namespace patchlight
