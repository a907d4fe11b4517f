#include "tracer/light/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/lights/sky.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/mirror.h"
#include "tracer/light/passed_lamps.h"
#include "tracer/sampling/pixel_samples.h"
#include "tracer/sampling/unseen.h"

namespace patchlight {

namespace {

constexpr float kRoulette = 0.02f;  // throughput of a faint path below which it goes on by chance

std::int32_t combined_hash(std::int32_t surfaces, std::int32_t next) {
  return std::int32_t(std::uint32_t(hash64(std::uint64_t(std::uint32_t(surfaces)) << 32 | std::uint32_t(next))));
}

/// Seven levels for each channel. The points of a pixel on one surface share light, and those of a blurred pixel lie
/// far apart: so that light is not mixed with the reflectance at other places, only points of similar reflectance share
/// it.
std::int32_t brightness_levels(const Color& reflected) {
  std::int32_t levels = 0;
  for (int k = 0; k < 3; ++k) levels = 8 * levels + int(6.5f * std::sqrt(std::clamp(reflected[k], 0.0f, 1.0f)));
  return levels;
}

}  // namespace

PathTracer::PathTracer(const PatchSet& scene, const RayScene& ray_scene, const Outlines& outlines,
                       const SolvedSurfaces& surfaces, const LightMixes& mixes, const GlossyLights* glossy_lights,
                       const TraceConfig& config)
    : scene_(scene),
      ray_scene_(ray_scene),
      outlines_(outlines),
      surfaces_(surfaces),
      mixes_(mixes),
      config_(config),
      direct_(config.quality != "patches"),
      gather_(config.quality == "gather"),
      normals_(scene),
      coats_(scene),
      glossy_lights_(glossy_lights) {
  if (has_intangible(scene.primitives)) lamps_.emplace(scene, surfaces, mixes, glossy_lights);
}

void PathTracer::trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
                       PathSums& sums) const {
  trace_to_ends(packet, paths, camera, sums);
  while (!sums.parts.empty()) {
    for (int lane = 0; lane < RayPacket::kSize && !sums.parts.empty(); ++lane) {
      paths[lane] = sums.parts.back().path;
      packet.set(lane, sums.parts.back().origin, sums.parts.back().direction);
      sums.parts.pop_back();
    }
    trace_to_ends(packet, paths, camera, sums);
  }
}

void PathTracer::trace_to_ends(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
                               PathSums& sums) const {
  for (bool coherent = true, active = true; active; coherent = false) {
    ray_scene_.intersect(packet, coherent);
    if (lamps_) lamps_->add(packet, paths, sums);
    active = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      if (shade(packet, lane, paths[lane], camera, sums)) {
        active = true;
        continue;
      }
      packet.valid[lane] = 0;
      if (!sums.details.empty() && !paths[lane].is_part) sums.details[paths[lane].pixel].add(paths[lane].features);
    }
    if (sums.lifted && sums.lifted->pending) move_lifted_points(sums);
    if (sums.glossy_rays && sums.glossy_rays->pending) add_glossy_light(paths, sums);
  }
}

bool PathTracer::shade(RayPacket& packet, int lane, Path& path, const CameraRays& camera, PathSums& sums) const {
  const SurfaceHit hit = ray_scene_.hit(packet, lane);
  PathFeatures& features = path.features;
  LayerSums* const layers = sums.layers;
  const bool in_layers = layers && layers->has_surfaces() && std::isinf(features.depth);
  const auto add_surface = [&](const LayerSums::Surface& surface) {
    path.central ? layers->set_surface(path.pixel, surface)
                 : layers->add_surface(path.pixel, surface, path.center_distance2);
  };
  if (hit.primitive < 0) {
    if (in_layers) add_surface({});
    if (scene_.environment && !path.central) add_sky(packet.direction(lane), path, sums);
    return false;
  }
  const SurfacePoint point = surface_point(hit);
  Vec3f direction = packet.direction(lane);
  const bool is_passed = path.kind() == ShadingPoint::PathKind::direct && is_unseen(scene_, hit.primitive);
  if (is_passed || (!hit.front && config_.cull_backfaces)) {
    path.pdf = 0;  // shadow rays do not pass back faces: no MIS
    packet.set(lane, ray_scene_.to_local(point.position) + direction * ray_scene_.offset(hit.primitive), direction);
    if (!path.mirrored) camera.set_end(packet, lane, point.position, direction);
    return ++path.bounces < kMaxBounces;
  }
  if (std::isinf(features.depth)) features.depth = float(camera.depth(point.position));
  const bool is_passable = packet.passable >> lane & 1u;
  if (!hit.front) {
    if (in_layers) add_surface({features.depth, point.position, -point.normal});
    return is_passable && !path.central && pass(hit, point, lane, path, packet, sums);
  }
  SolvedSurfaces::Colors colors = surfaces_.colors(hit);
  const Vec3f of_mesh = normals_(hit.primitive, hit.u, hit.v, point.normal);
  const Vec3f smooth = normals_.mapped(hit.primitive, hit.u, hit.v, of_mesh);
  const Vec3f normal = valid_for_viewer(smooth, point.normal, -direction);
  if (!path.faint) features.normal = of_mesh;
  if (in_layers) add_surface({features.depth, point.position, normal, colors.reflectance, std::uint32_t(colors.patch)});
  if (path.central) return false;
  const std::int32_t material = scene_.primitives[hit.primitive].material;
  SpecularProperties specular;
  Color albedo(0.0f);  // of the coat
  if (is_specular(scene_.materials[material])) {
    specular = specular_properties_at(scene_, hit.primitive, hit.u, hit.v);
    albedo = coats_.at(material, specular, -(direction ^ normal));
    if (specular.has_coat()) colors.reflectance *= Color(1.0f) - albedo;
  }
  if (is_passable && scene_.primitives[hit.primitive].mask >= 0) {
    const float alpha = alpha_at(scene_, hit.primitive, hit.u, hit.v);
    colors.reflectance *= alpha;
    colors.emission *= alpha;
  }
  if (path.pdf > 0)
    colors.emission *= glossy_lights_->hit_weight(sums.glossy_rays->vertices[lane], direction, path.pdf, colors.patch);
  const DisplayLookup::Blend blend = surfaces_.blend(hit, colors.patch);
  const bool looked_up = path.faint && direct_;
  const auto radiance = [&](std::size_t mix) {
    const Color irradiance =
        looked_up ? surfaces_.total_irradiance(hit, blend, mix) : surfaces_.irradiance(hit, blend, mix);
    return path.throughput * (surfaces_.emission(colors, mix) + colors.reflectance * irradiance) / float(kPi);
  };
  const Color contribution =
      gather_ && !looked_up ? path.throughput * surfaces_.emission(colors) / float(kPi) : radiance(0);
  sums.pixels[path.pixel] += contribution;
  if (layers) add_layers(hit, colors, blend, path, *layers);
  const std::int32_t surface = outlines_.surface(hit.primitive);
  features.light += mixes_.unscaled == 0 && (!gather_ || looked_up) ? contribution : radiance(mixes_.unscaled);
  if (!path.faint) {
    features.surface = combined_hash(features.surface, surface);
    features.reflectance += path.throughput * colors.reflectance;
  }
  const Vec3d ray_origin = point.position + Vec3d(point.normal) * double(ray_scene_.offset(hit.primitive));
  if (direct_ && !looked_up && max_component(colors.reflectance) > 0) {
    const Color reflected = path.throughput * colors.reflectance;
    sums.points.push_back(
        {path.pixel, camera.has_lens() ? combined_hash(surface, brightness_levels(reflected)) : surface, hit.primitive,
         path.kind(), ray_origin, normal, reflected / float(kPi), normal == smooth ? Vec3f(0.0f) : smooth});
    if (gather_) sums.gather.push_back({sums.points.back(), point.normal, path.sample, std::uint32_t(path.bounces)});
    if (!normals_.is_flat(hit.primitive)) lift_point(hit, lane, sums);
  }
  if (is_passable) return pass(hit, point, lane, path, packet, sums);
  if (specular.is_black() || !survives(specular, albedo, path, sums) ||
      !scatter(specular, ray_origin, normal, point.normal, lane, path, direction, sums) ||
      max_component(path.throughput) < kMinThroughput || ++path.bounces >= kMaxBounces)
    return false;
  packet.set(lane, ray_scene_.to_local(ray_origin), direction);
  return true;
}

/// Adds the environment to a path that leaves the scene; without suns after a rough surface, where they are explicitly
/// sampled.
void PathTracer::add_sky(const Vec3f& direction, Path& path, PathSums& sums) const {
  const Environment& sky = *scene_.environment;
  const bool explicit_suns = path.pdf > 0;
  const Color unscaled =
      path.throughput * (explicit_suns ? clipped_radiance(sky, direction) : sky_radiance(sky, direction));
  const auto group = std::size_t(sky.light_group);
  const Color contribution = unscaled * mixes_.all[0][group];
  sums.pixels[path.pixel] += contribution;
  path.features.light += unscaled;
  if (!sums.layers) return;
  if (sums.layers->has_light()) sums.layers->add_emission(path.pixel, path.mirrored, contribution);
  if (sums.layers->has_groups()) sums.layers->add_to_group(group, path.pixel, unscaled);
}

/// Whether a path goes on to a reflection by metal or by a coat of this albedo: by Russian roulette if it is faint,
/// which it stays.
bool PathTracer::survives(const SpecularProperties& specular, const Color& albedo, Path& path,
                          const PathSums& sums) const {
  const float reflected = max_component(path.throughput * (specular.metal + albedo));
  if (!path.faint) {
    path.faint = specular.metal == Color(0.0f) && reflected < kFaint;
    return true;
  }
  const float chance = reflected / kRoulette;
  if (chance >= 1) return true;
  const std::uint64_t random = hash64(hash64(sums.window->pixel_id(path.pixel)) ^
                                      (std::uint64_t(path.sample) << 8 | std::uint64_t(path.bounces)));
  if (uniform01(random) >= chance) return false;
  path.throughput /= chance;
  return true;
}

bool PathTracer::scatter(const SpecularProperties& specular, const Vec3d& origin, const Vec3f& smooth_normal,
                         const Vec3f& geometric_normal, int lane, Path& path, Vec3f& direction, PathSums& sums) const {
  path.mirrored = true;
  path.pdf = 0;
  Vec2f at(0.0f);
  const Vec3f in = direction;
  const bool rough = specular.roughness >= kMirrorRoughness;
  if (rough) {
    GlossyShadowRays& rays = sums.glossy_rays ? *sums.glossy_rays : sums.glossy_rays.emplace();
    rays.vertices[lane] = {origin, smooth_normal, in, specular.roughness};
    const std::uint64_t seed = hash64(~hash64(sums.window->pixel_id(path.pixel)) + std::uint64_t(path.bounces));
    at = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(seed))), seed);
    sample_glossy_light(specular, hash64(~seed), lane, path, rays);
  }
  path.scattered = path.scattered || rough;
  path.features.scattered = path.features.scattered || (rough && !path.faint);
  if (!reflect(specular, smooth_normal, at, direction, path.throughput)) return false;
  if (rough) path.pdf = specular_lobe(specular.roughness, smooth_normal, in, direction).density;
  // By a smooth normal the reflection may point below the facet.
  if ((direction ^ geometric_normal) < 0) direction -= geometric_normal * (2.0f * (direction ^ geometric_normal));
  return true;
}

/// Prepares the last shading point to be moved.
void PathTracer::lift_point(const SurfaceHit& hit, int lane, PathSums& sums) const {
  const Vec3d& from = sums.points.back().position;
  const Vec3d to = normals_.on_smooth_surface(hit.primitive, hit.u, hit.v, from);
  const auto distance = float((to - from).length());
  if (distance <= ray_scene_.offset(hit.primitive)) return;
  LiftedPoints& lifted = sums.lifted ? *sums.lifted : sums.lifted.emplace();
  lifted.pending = true;
  lifted.points[lane] = sums.points.size() - 1;
  lifted.positions[lane] = to;
  lifted.packet.set_shadow(lane, ray_scene_.to_local(from), Vec3f(to - from) / distance, distance);
}

void PathTracer::move_lifted_points(PathSums& sums) const {
  LiftedPoints& lifted = *sums.lifted;
  const std::uint32_t blocked = ray_scene_.occluded(lifted.packet);
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    if (lifted.packet.valid[lane] == 0) continue;
    lifted.packet.valid[lane] = 0;
    if (!(blocked >> lane & 1u)) sums.points[lifted.points[lane]].position = lifted.positions[lane];
  }
  lifted.pending = false;
}

void PathTracer::add_layers(const SurfaceHit& hit, const SolvedSurfaces::Colors& colors,
                            const DisplayLookup::Blend& blend, const Path& path, LayerSums& layers) const {
  const Color factor = path.throughput / float(kPi);
  const Color reflected = factor * colors.reflectance;
  if (layers.has_light()) layers.add_emission(path.pixel, path.mirrored, factor * surfaces_.emission(colors));
  if (layers.has_light() && !gather_) {
    const Color irradiance = surfaces_.irradiance(hit, blend), direct = surfaces_.direct_part(hit, irradiance);
    layers.add_direct(path.pixel, path.mirrored, reflected * direct);
    layers.add_indirect(path.pixel, path.mirrored, reflected * (irradiance - direct));
  }
  for (std::size_t g = 0; g < layers.group_count(); ++g) {
    const std::size_t mix = mixes_.first_group + g;
    layers.add_to_group(g, path.pixel, factor * surfaces_.emission(colors, mix));
    if (!gather_) layers.add_to_group(g, path.pixel, reflected * surfaces_.irradiance(hit, blend, mix));
  }
}

/// Computed from (u,v), since the error of the ray's end point grows with the length of the ray.
SurfacePoint PathTracer::surface_point(const SurfaceHit& hit) const {
  const Primitive& p = scene_.primitives[hit.primitive];
  if (p.shape == Primitive::Shape::sphere) return point_at(p, hit.u, hit.v);
  const auto& c = p.corners;
  const double u = hit.u, v = hit.v;
  return {(c[0] * (1 - u) + c[1] * u) * (1 - v) + (c[3] * (1 - u) + c[2] * u) * v,
          Vec3f(outlines_.normal(hit.primitive))};
}

}  // namespace patchlight
