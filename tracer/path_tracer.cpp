#include "tracer/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/mirror.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"
#include "pipeline/optics/texture_lookup.h"

namespace patchlight {

namespace {

constexpr float kLeastThroughput = 1e-3f;
constexpr int kMostMirrors = 64;

float largest(const Color& c) {
  return std::max({c.x, c.y, c.z});
}

}  // namespace

PathTracer::PathTracer(const PatchSet& scene, const RayScene& ray_scene, const Outlines& outlines,
                       const EnergyField& energy, const TraceConfig& config, const std::vector<Color>& settings,
                       const std::vector<Color>& emission)
    : scene_(scene),
      ray_scene_(ray_scene),
      outlines_(outlines),
      config_(config),
      settings_(settings),
      emission_(emission),
      direct_(config.quality == "direct"),
      lookup_(scene),
      irradiance_(direct_ ? irradiance_without_apart(energy, settings, scene.patches.size())
                          : irradiance(energy, settings, scene.patches.size())),
      irradiance_lookup_(scene, lookup_, irradiance_),
      normals_(scene),
      shaders_([&scene] { return compile_shaders(scene); }) {
  if (direct_ && energy.display) display_.emplace(scene, ray_scene, irradiance_lookup_, energy, settings);
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
  }
}

bool PathTracer::shade(RayPacket& packet, int lane, Path& path, const CameraRays& camera, PathSums& sums) const {
  const SurfaceHit hit = ray_scene_.hit(packet, lane);
  if (hit.primitive < 0) return false;
  const Primitive& primitive = scene_.primitives[hit.primitive];
  const SurfacePoint point = point_of(hit);
  const Vec3f direction = packet.direction(lane);
  PathView& view = path.view;
  const auto see = [&] {
    if (std::isinf(view.depth)) view.depth = float(-camera.to_camera(point.position).z);
  };
  if (!hit.front) {
    if (!config_.cull_backfaces) return see(), false;
    packet.set(lane, ray_scene_.to_local(point.position) + direction * ray_scene_.offset(hit.primitive), direction);
    return ++path.mirrors < kMostMirrors;
  }
  see();
  const std::int32_t i = lookup_.patch(hit.primitive, hit.u, hit.v);
  const Material& material = scene_.materials[primitive.material];
  const bool mirror = material.roughness < kMirrorRoughness;
  Color reflectance = scene_.patches[i].reflectance;
  Color emission = emission_[i];
  if (primitive.texture >= 0) reflectance = textured_reflectance(scene_, hit.primitive, hit.u, hit.v);
  if (primitive.shader >= 0) apply_shader(hit, reflectance, emission);
  if (!mirror) reflectance += material.specular;
  const Color radiance =
      path.throughput * (emission + reflectance * irradiance_at(hit, i, path.pixel, sums)) / float(kPi);
  sums.pixels[path.pixel] += radiance;
  const std::int32_t surface = outlines_.surface(hit.primitive);
  view.surface =
      std::int32_t(std::uint32_t(scramble(std::uint64_t(std::uint32_t(view.surface)) << 32 | std::uint32_t(surface))));
  view.normal = normals_(hit.primitive, hit.u, hit.v, point.normal);
  view.light += radiance;
  view.reflectance += path.throughput * reflectance;
  const Vec3d off = point.position + Vec3d(point.normal) * double(ray_scene_.offset(hit.primitive));
  if (direct_ && largest(reflectance) > 0)
    sums.points.push_back(
        {path.pixel, surface, hit.primitive, off, view.normal, path.throughput * reflectance / float(kPi)});
  path.throughput *= material.specular;
  if (!mirror || largest(path.throughput) < kLeastThroughput || ++path.mirrors >= kMostMirrors) return false;
  packet.set(lane, ray_scene_.to_local(off), direction - point.normal * (2.0f * (point.normal ^ direction)));
  return true;
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

Color PathTracer::irradiance_at(const SurfaceHit& hit, std::int32_t patch, std::uint32_t pixel, PathSums& sums) const {
  if (!display_) return irradiance_lookup_(hit.primitive, hit.u, hit.v);
  sums.seen.start(pixel);
  return (*display_)(hit.primitive, patch, hit.u, hit.v, sums.seen);
}

void PathTracer::apply_shader(const SurfaceHit& hit, Color& reflectance, Color& emission) const {
  const Primitive& p = scene_.primitives[hit.primitive];
  MaterialShader& shader = shaders_.local()[p.shader];
  if (shader.reflects()) reflectance = shaded_reflectance(scene_, shader, hit.primitive, hit.u, hit.v);
  if (!shader.emits()) return;
  const ExpressionInputs at = shader_inputs(scene_, hit.primitive, hit.u, hit.v);
  emission = within_range(shader.emission(at), Color(kMostEmission)) * settings_[p.light_group];
}

}  // namespace patchlight
