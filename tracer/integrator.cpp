#include "tracer/integrator.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>

#include "pipeline/files/job_check.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"
#include "tracer/camera_rays.h"

namespace patchlight {

namespace {

constexpr float kMirrorRoughness = 0.05f;  // below it a metal is a perfect mirror
constexpr float kLeastThroughput = 1e-3f;
constexpr int kMostMirrors = 64;
constexpr int kTile = 16;  // pixels along a tile's edge

std::vector<Color> lit_emission(const PatchSet& scene, const std::vector<Color>& settings) {
  std::vector<Color> emission(scene.patches.size(), Color(0.0f));
  for (std::size_t i = 0; i < emission.size(); ++i) {
    const std::int32_t group = scene.primitives[scene.patches[i].primitive].light_group;
    if (group >= 0) emission[i] = scene.patches[i].emission * settings[group];
  }
  return emission;
}

/// A shift in [0,1)^2 for each pixel.
Vec2f pixel_shift(std::size_t pixel) {
  const std::uint64_t x = scramble(pixel);
  return {to_unit(x), to_unit(x << 24)};
}

/// Sample k of n in the pixel: a rank-1 lattice with the golden ratio's step, which stratifies both axes.
Vec2f sample_point(int k, int n, const Vec2f& shift) {
  const float x = (float(k) + shift.x) / float(n);
  const float y = float(double(k) * 0.6180339887498949 - std::floor(double(k) * 0.6180339887498949)) + shift.y;
  return {x, y >= 1.0f ? y - 1.0f : y};
}

float largest(const Color& c) {
  return std::max({c.x, c.y, c.z});
}

}  // namespace

Integrator::Integrator(const PatchSet& scene, const EnergyField& energy, const Job& job)
    : scene_(scene),
      config_(job.trace),
      ray_scene_(scene),
      lookup_(scene),
      settings_(light_settings(job, scene)),
      emission_(lit_emission(scene, settings_)),
      irradiance_(irradiance(energy, settings_, scene.patches.size())),
      irradiance_lookup_(scene, lookup_, irradiance_),
      shaders_([&scene] { return compile_shaders(scene); }) {}

Image Integrator::render(const Camera& camera, Progress& progress) const {
  const auto [width, height] = config_.resolution;
  Image image{width, height, std::vector<Color>(std::size_t(width) * height, Color(0.0f)), {}};
  const CameraRays rays(camera, width, height);
  const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
  constexpr int kRowsAtOnce = 4;  // of tiles, between two looks at the signals
  for (int first = 0; first < down; first += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, down - first) * across;
    tbb::parallel_for(0, count, [&](int index) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      const int x0 = index % across * kTile, y0 = (first + index / across) * kTile;
      RayPacket packet;
      packet.clear();
      std::array<Path, RayPacket::kSize> paths;
      int lane = 0;
      for (int y = y0; y < std::min(y0 + kTile, height); ++y)
        for (int x = x0; x < std::min(x0 + kTile, width); ++x) {
          const std::size_t pixel = std::size_t(y) * width + x;
          const Vec2f shift = pixel_shift(pixel);
          for (int k = 0; k < config_.samples; ++k) {
            const Vec2f at = sample_point(k, config_.samples, shift);
            const CameraRay ray = rays(float(x) + at.x, float(y) + at.y);
            packet.set(lane, ray_scene_.to_local(ray.origin), ray.direction);
            paths[lane] = {pixel, Color(1.0f), 0};
            if (++lane < RayPacket::kSize) continue;
            trace(packet, paths, image.pixels.data());
            lane = 0;
          }
        }
      if (lane > 0) trace(packet, paths, image.pixels.data());
    });
    progress.update(double(first + 1) / down, camera.name);
  }
  for (Color& pixel : image.pixels) pixel /= float(config_.samples);
  return image;
}

void Integrator::trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, Color* pixels) const {
  for (bool coherent = true, going = true; going; coherent = false) {
    ray_scene_.intersect(packet, coherent);
    going = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      if (shade(packet, lane, paths[lane], pixels))
        going = true;
      else
        packet.valid[lane] = 0;
    }
  }
}

bool Integrator::shade(RayPacket& packet, int lane, Path& path, Color* pixels) const {
  const SurfaceHit hit = ray_scene_.hit(packet, lane);
  if (hit.primitive < 0) return false;
  const Vec3f direction = packet.direction(lane);
  if (!hit.front) {
    if (!config_.cull_backfaces) return false;
    packet.set(lane, ray_scene_.to_local(point_of(hit).position) + direction * ray_scene_.offset(hit.primitive),
               direction);
    return ++path.mirrors < kMostMirrors;
  }
  const std::int32_t i = lookup_.patch(hit.primitive, hit.u, hit.v);
  const Material& material = scene_.materials[scene_.primitives[hit.primitive].material];
  const bool mirror = material.roughness < kMirrorRoughness;
  Color reflectance = scene_.patches[i].reflectance;
  Color emission = emission_[i];
  if (scene_.primitives[hit.primitive].shader >= 0) apply_shader(hit, reflectance, emission);
  if (!mirror) reflectance += material.specular;
  const Color radiance = (emission + reflectance * irradiance_lookup_(hit.primitive, hit.u, hit.v)) / float(kPi);
  pixels[path.pixel] += path.throughput * radiance;
  path.throughput *= material.specular;
  if (!mirror || largest(path.throughput) < kLeastThroughput || ++path.mirrors >= kMostMirrors) return false;
  const SurfacePoint point = point_of(hit);
  packet.set(lane, ray_scene_.to_local(point.position) + point.normal * ray_scene_.offset(hit.primitive),
             direction - point.normal * (2.0f * (point.normal ^ direction)));
  return true;
}

/// From (u,v), since the ray's own end is only as exact as the ray is long.
SurfacePoint Integrator::point_of(const SurfaceHit& hit) const {
  return point_at(scene_.primitives[hit.primitive], hit.u, hit.v);
}

void Integrator::apply_shader(const SurfaceHit& hit, Color& reflectance, Color& emission) const {
  const Primitive& p = scene_.primitives[hit.primitive];
  MaterialShader& shader = shaders_.local()[p.shader];
  const ExpressionInputs at = shader_inputs(scene_, hit.primitive, hit.u, hit.v);
  if (shader.reflects()) {
    reflectance = within_range(shader.reflectance(at), most_reflectance(scene_.materials[p.material]));
  }
  if (shader.emits()) emission = within_range(shader.emission(at), Color(kMostEmission)) * settings_[p.light_group];
}

}  // namespace patchlight
