#include "tracer/light/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/lights/sky.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/mirror.h"
#include "tracer/sampling/pixel_samples.h"

namespace patchlight {

namespace {

constexpr float kLeastThroughput = 1e-3f;
constexpr int kMostMirrors = 64;

float largest(const Color& c) {
  return std::max({c.x, c.y, c.z});
}

}  // namespace

PathTracer::PathTracer(const PatchSet& scene, const RayScene& ray_scene, const Outlines& outlines,
                       const SolvedSurfaces& surfaces, const LightMixes& mixes, const TraceConfig& config)
    : scene_(scene),
      ray_scene_(ray_scene),
      outlines_(outlines),
      surfaces_(surfaces),
      mixes_(mixes),
      config_(config),
      direct_(config.quality != "patches"),
      gather_(config.quality == "gather"),
      normals_(scene) {
  if (MetalLight::is_of_use(scene)) metals_.emplace(scene, ray_scene, mixes.all[0]);
}

void PathTracer::trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
                       PathSums& sums) const {
  for (bool coherent = true, going = true; going; coherent = false) {
    ray_scene_.intersect(packet, coherent);
    going = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      if (shade(packet, lane, paths[lane], camera, sums)) {
        going = true;
        continue;
      }
      packet.valid[lane] = 0;
      if (!sums.details.empty()) sums.details[paths[lane].pixel].add(paths[lane].view);
    }
    if (sums.metal_rays && sums.metal_rays->any) add_metal_light(paths, sums);
  }
}

bool PathTracer::shade(RayPacket& packet, int lane, Path& path, const CameraRays& camera, PathSums& sums) const {
  const SurfaceHit hit = ray_scene_.hit(packet, lane);
  PathView& view = path.view;
  LayerSums* const layers = sums.layers;
  const bool in_layers = layers && layers->surface() && std::isinf(view.depth);
  if (hit.primitive < 0) {
    if (in_layers) layers->add_surface(path.pixel, {}, path.off);
    if (scene_.environment) show_sky(packet.direction(lane), path, sums);
    return false;
  }
  const SurfacePoint point = point_of(hit);
  Vec3f direction = packet.direction(lane);
  if (!hit.front && config_.cull_backfaces) {
    path.density = 0;  // rays to emitters do not look through
    packet.set(lane, ray_scene_.to_local(point.position) + direction * ray_scene_.offset(hit.primitive), direction);
    return ++path.surfaces < kMostMirrors;
  }
  if (std::isinf(view.depth)) view.depth = float(camera.depth(point.position));
  if (!hit.front) {
    if (in_layers) layers->add_surface(path.pixel, {view.depth, point.position, -point.normal}, path.off);
    return false;
  }
  SolvedSurfaces::Colors colors = surfaces_.colors(hit);
  view.normal = normals_(hit.primitive, hit.u, hit.v, point.normal);
  if (in_layers)
    layers->add_surface(path.pixel,
                        {view.depth, point.position, view.normal, colors.reflectance, std::uint32_t(colors.patch)},
                        path.off);
  if (path.density > 0)
    colors.emission *= metals_->part_hit(sums.metal_rays->places[lane], direction, path.density, colors.patch);
  sums.seen.start(path.pixel);
  const DisplayLookup::Blend blend = surfaces_.blend(hit, colors.patch, sums.seen);
  const auto radiance = [&](std::size_t mix) {
    return path.throughput *
           (surfaces_.emission(colors, mix) + colors.reflectance * surfaces_.irradiance(hit, blend, mix)) / float(kPi);
  };
  const Color shown = gather_ ? path.throughput * surfaces_.emission(colors) / float(kPi) : radiance(0);
  sums.pixels[path.pixel] += shown;
  if (layers) add_layers(hit, colors, blend, path, *layers);
  const std::int32_t surface = outlines_.surface(hit.primitive);
  view.surface =
      std::int32_t(std::uint32_t(hash64(std::uint64_t(std::uint32_t(view.surface)) << 32 | std::uint32_t(surface))));
  view.light += mixes_.own == 0 && !gather_ ? shown : radiance(mixes_.own);
  view.reflectance += path.throughput * colors.reflectance;
  const Vec3d off = point.position + Vec3d(point.normal) * double(ray_scene_.offset(hit.primitive));
  if (direct_ && largest(colors.reflectance) > 0) {
    using Way = ShadingPoint::Way;
    const Way way = view.scattered ? Way::scattered : path.mirrored ? Way::mirrored : Way::straight;
    sums.points.push_back(
        {path.pixel, surface, hit.primitive, way, off, view.normal, path.throughput * colors.reflectance / float(kPi)});
    if (gather_) sums.gather.push_back({sums.points.back(), point.normal, path.sample, std::uint32_t(path.surfaces)});
  }
  if (scene_.materials[scene_.primitives[hit.primitive].material].specular == Color(0.0f)) return false;
  const MetallicRoughness metal = metallic_roughness_at(scene_, hit.primitive, hit.u, hit.v);
  if (metal.specular == Color(0.0f) || !turn(metal, off, view.normal, point.normal, lane, path, direction, sums) ||
      largest(path.throughput) < kLeastThroughput || ++path.surfaces >= kMostMirrors)
    return false;
  packet.set(lane, ray_scene_.to_local(off), direction);
  return true;
}

/// What a path comes to that meets nothing. Suns that rough metals show are not met but looked at.
void PathTracer::show_sky(const Vec3f& direction, Path& path, PathSums& sums) const {
  const Environment& sky = *scene_.environment;
  const bool explicit_light = path.density > 0;
  const Color own =
      path.throughput * (explicit_light ? clipped_radiance(sky, direction) : sky_radiance(sky, direction));
  const auto group = std::size_t(sky.light_group);
  const Color shown = own * mixes_.all[0][group];
  sums.pixels[path.pixel] += shown;
  path.view.light += own;
  if (!sums.layers) return;
  if (sums.layers->light()) sums.layers->add_emission(path.pixel, path.mirrored, shown);
  if (sums.layers->groups()) sums.layers->add_of_group(group, path.pixel, own);
}

bool PathTracer::turn(const MetallicRoughness& metal, const Vec3d& off, const Vec3f& normal, const Vec3f& flat,
                      int lane, Path& path, Vec3f& direction, PathSums& sums) const {
  path.mirrored = true;
  path.density = 0;
  Vec2f at(0.0f);
  const Vec3f in = direction;
  const bool rough = metal.roughness >= kMirrorRoughness;
  if (rough) {
    path.view.scattered = true;
    MetalRays& rays = sums.metal_rays ? *sums.metal_rays : sums.metal_rays.emplace();
    rays.places[lane] = {off, normal, in, metal.roughness};
    const std::uint64_t seed = hash64(~hash64(sums.window->place(path.pixel)) + std::uint64_t(path.surfaces));
    at = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(seed))), seed);
    ask_for_metal_light(metal, hash64(~seed), lane, path, rays);
  }
  if (!reflect(metal, normal, at, direction, path.throughput)) return false;
  if (rough) path.density = metal_lobe(metal.roughness, normal, in, direction).density;
  // A smooth normal may turn it below the facet that it left.
  if ((direction ^ flat) < 0) direction -= flat * (2.0f * (direction ^ flat));
  return true;
}

void PathTracer::ask_for_metal_light(const MetallicRoughness& metal, std::uint64_t seed, int lane, const Path& path,
                                     MetalRays& rays) const {
  const Vec2f at = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(seed))), seed);
  const std::uint64_t other = hash64(seed);
  const float choice = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(other))), other).x;
  const MetalLight::Sample sample = metals_->sample(rays.places[lane], choice, at);
  if (sample.weight <= 0) return;
  rays.any = true;
  rays.samples[lane] = sample;
  rays.throughputs[lane] = path.throughput * metal.specular;
  rays.packet.set_shadow(lane, ray_scene_.to_local(rays.places[lane].position), sample.direction, sample.distance);
}

/// Of the rays that a packet's paths have asked for.
void PathTracer::add_metal_light(std::array<Path, RayPacket::kSize>& paths, PathSums& sums) const {
  MetalRays& rays = *sums.metal_rays;
  const std::uint32_t hidden = ray_scene_.occluded(rays.packet);
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    if (rays.packet.valid[lane] == 0) continue;
    rays.packet.valid[lane] = 0;
    if (hidden >> lane & 1u) continue;
    const MetalLight::Sample& sample = rays.samples[lane];
    const std::uint32_t pixel = paths[lane].pixel;
    const Color through = rays.throughputs[lane] * sample.weight / float(kPi);
    sums.pixels[pixel] += through * sample.lamp->exitance;
    if (!sums.layers) continue;
    if (sums.layers->light()) sums.layers->add_emission(pixel, true, through * sample.lamp->exitance);
    if (sums.layers->groups())
      sums.layers->add_of_group(std::size_t(sample.lamp->group), pixel, through * sample.lamp->own);
  }
  rays.any = false;
}

void PathTracer::add_layers(const SurfaceHit& hit, const SolvedSurfaces::Colors& colors,
                            const DisplayLookup::Blend& blend, const Path& path, LayerSums& layers) const {
  const Color through = path.throughput / float(kPi);
  const Color reflected = through * colors.reflectance;
  if (layers.light()) layers.add_emission(path.pixel, path.mirrored, through * surfaces_.emission(colors));
  if (layers.light() && !gather_) {
    const Color irradiance = surfaces_.irradiance(hit, blend), direct = surfaces_.direct_part(hit, irradiance);
    layers.add_direct(path.pixel, path.mirrored, reflected * direct);
    layers.add_indirect(path.pixel, path.mirrored, reflected * (irradiance - direct));
  }
  for (std::size_t g = 0; g < layers.group_count(); ++g) {
    const std::size_t mix = mixes_.groups + g;
    layers.add_of_group(g, path.pixel, through * surfaces_.emission(colors, mix));
    if (!gather_) layers.add_of_group(g, path.pixel, reflected * surfaces_.irradiance(hit, blend, mix));
  }
}

/// From (u,v), since the ray's own end is only as exact as the ray is long.
SurfacePoint PathTracer::point_of(const SurfaceHit& hit) const {
  const Primitive& p = scene_.primitives[hit.primitive];
  if (p.shape == Primitive::Shape::sphere) return point_at(p, hit.u, hit.v);
  const auto& c = p.corners;
  const double u = hit.u, v = hit.v;
  return {(c[0] * (1 - u) + c[1] * u) * (1 - v) + (c[3] * (1 - u) + c[2] * u) * v,
          Vec3f(outlines_.normal(hit.primitive))};
}

}  // namespace patchlight
