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

constexpr std::uint32_t kCoatParts = 4;
constexpr float kRoulette = 0.02f;  // throughput of a faint path below which it goes on by chance

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
      if (paths[lane].pdf > 0) sums.glossy_rays->vertices[lane] = sums.parts.back().vertex;
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
  const bool is_passed = path.is_direct() && is_unseen(scene_, hit.primitive);
  if (is_passed || (!hit.front && config_.cull_backfaces)) {
    path.pdf = 0;  // shadow rays do not pass back faces: no MIS
    packet.set(lane, ray_scene_.to_local(point.position) + direction * ray_scene_.offset(hit.primitive), direction);
    if (path.is_direct()) camera.set_end(packet, lane, point.position, direction);
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
    albedo = coats_.at(specular, -(direction ^ normal));
    if (scene_.materials[material].is_coated()) colors.reflectance *= Color(1.0f) - albedo;
  }
  float alpha = 1.0f;
  if (is_passable && scene_.primitives[hit.primitive].mask >= 0) {
    alpha = alpha_at(scene_, hit.primitive, hit.u, hit.v);
    colors.reflectance *= alpha;
    colors.emission *= alpha;
  }
  if (path.pdf > 0)
    colors.emission *=
        glossy_lights_->hit_weight(sums.glossy_rays->vertices[lane], direction, path.pdf, colors.patch, path.mirror);
  const Vec3d offset = Vec3d(point.normal) * double(ray_scene_.offset(hit.primitive));
  const Vec3d ray_origin = point.position + offset;
  if (!path.faint) features.surface = combined_hash(features.surface, outlines_.surface(hit.primitive));
  add_diffuse_light({hit, colors, ray_origin, normal, smooth, point.normal}, lane, camera, path, sums);
  if (is_translucent(scene_, scene_.primitives[hit.primitive])) {
    const SurfaceHit behind = surfaces_.behind(hit);
    SolvedSurfaces::Colors passed = surfaces_.passed_colors(behind);
    passed.reflectance *= (Color(1.0f) - albedo) * alpha;
    add_diffuse_light({behind, passed, point.position - offset, -smooth, -smooth, -point.normal}, lane, camera, path,
                      sums);
  }
  if (is_passable) return pass(hit, point, lane, path, packet, sums);
  if (specular.is_black() || !survives(specular, albedo, path, sums)) return false;
  Vec3f reflecting = normal;
  if (specular.clear_coat.exists()) {
    const Vec3f of_coat = valid_for_viewer(of_mesh, point.normal, -direction);
    const bool by_coat = reflects_at_clear_coat(hit, point, specular, of_coat, direction, path, sums);
    if (by_coat) reflecting = of_coat;
    specular = by_coat ? specular.clear_layer() : specular.below();
  }
  if (specular.is_black() ||
      !scatter(specular, hit.primitive, ray_origin, reflecting, point.normal, lane, path, direction, sums) ||
      max_component(path.whole_throughput()) < kMinThroughput || ++path.bounces >= kMaxBounces)
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
  path.features.light += unscaled * path.parts;
  if (!sums.layers) return;
  if (sums.layers->has_light()) sums.layers->add_emission(path.pixel, path.seen_by, contribution);
  if (sums.layers->has_groups()) sums.layers->add_to_group(group, path.pixel, unscaled);
}

/// Whether a path goes on to a reflection by metal or by a coat of this albedo: by Russian roulette if it is faint,
/// which it stays.
bool PathTracer::survives(const SpecularProperties& specular, const Color& albedo, Path& path,
                          const PathSums& sums) const {
  const float reflected = max_component(path.whole_throughput() * (specular.metal + albedo));
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

bool PathTracer::scatter(const SpecularProperties& specular, std::int32_t primitive, const Vec3d& origin,
                         const Vec3f& smooth_normal, const Vec3f& geometric_normal, int lane, Path& path,
                         Vec3f& direction, PathSums& sums) const {
  path.turn(max_component(specular.metal) >= max_component(specular.coat) ? SeenBy::metal : SeenBy::coat);
  const bool rough = specular.roughness >= kMirrorRoughness;
  // Where a mirror shows images of lamps, what a rough surface sees in it is weighted as what it sees itself.
  const bool shows_images = !rough && path.pdf > 0 && path.mirror < 0;
  path.mirror = shows_images ? glossy_lights_->mirror(primitive) : -1;
  if (path.mirror < 0) path.pdf = 0;
  const auto above = [&](const Vec3f& out) {  // by a smooth normal the reflection may point below the facet
    const float height = out ^ geometric_normal;
    return height < 0 ? out - geometric_normal * (2.0f * height) : out;
  };
  if (!rough) {
    reflect(specular, smooth_normal, Vec2f(0.0f), direction, path.throughput);
    direction = above(direction);
    return true;
  }
  path.scattered = true;
  path.features.scattered = path.features.scattered || !path.faint;
  GlossyShadowRays& rays = sums.glossy_rays ? *sums.glossy_rays : sums.glossy_rays.emplace();
  rays.vertices[lane] = {origin, smooth_normal, direction, specular.roughness};
  const std::uint64_t seed = hash64(~hash64(sums.window->pixel_id(path.pixel)) + std::uint64_t(path.bounces));
  sample_glossy_light(specular, hash64(~seed), lane, path, rays);
  // What a rough coat on the first surface shows is blurred and faint: the few first samples suffice for the rest of
  // the pixel, but not for a bright window in it.
  const bool by_coat = path.faint && path.bounces == 0 && !path.is_part;
  const bool is_split = by_coat && path.sample < sums.first_samples;
  const std::uint32_t parts = is_split ? kCoatParts : 1;
  const std::uint32_t first = is_split  ? kCoatParts * path.sample
                              : by_coat ? path.sample + (kCoatParts - 1) * sums.first_samples
                                        : path.sample;
  path.throughput /= float(parts);
  path.parts *= float(parts);
  const auto part_of = [&](std::uint32_t k, Path& part, Vec3f& out) {
    const Vec2f at = pixel_sample(shuffled(first + k, std::uint32_t(hash64(seed))), seed);
    if (!reflect(specular, smooth_normal, at, out, part.throughput)) return false;
    part.pdf = specular_lobe(specular.roughness, smooth_normal, rays.vertices[lane].direction, out).density;
    out = above(out);
    return true;
  };
  for (std::uint32_t k = 1; k < parts; ++k) {
    PathSums::Part part{path, ray_scene_.to_local(origin), direction, rays.vertices[lane]};
    part.path.is_part = true;
    ++part.path.bounces;
    if (part_of(k, part.path, part.direction)) sums.parts.push_back(part);
  }
  return part_of(0, path, direction);
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
