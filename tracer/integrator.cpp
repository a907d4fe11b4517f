#include "tracer/integrator.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>

#include "pipeline/files/job_check.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"
#include "pipeline/optics/texture_lookup.h"

namespace patchlight {

namespace {

constexpr float kMirrorRoughness = 0.05f;  // below it a metal is a perfect mirror
constexpr float kLeastThroughput = 1e-3f;
constexpr int kMostMirrors = 64;
constexpr int kTile = 16;                     // pixels along a tile's edge
constexpr std::size_t kMostPoints = 1 << 18;  // of a tile that wait for direct light

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
      irradiance_(config_.quality == "direct" ? irradiance_without_apart(energy, settings_, scene.patches.size())
                                              : irradiance(energy, settings_, scene.patches.size())),
      irradiance_lookup_(scene, lookup_, irradiance_),
      normals_(scene),
      shaders_([&scene] { return compile_shaders(scene); }) {
  if (config_.quality != "direct") return;
  lights_.emplace(scene, ray_scene_, emission_);
  if (energy.display) display_.emplace(scene, ray_scene_, irradiance_lookup_, energy, settings_);
}

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
      render(rays, index % across * kTile, (first + index / across) * kTile, image);
    });
    progress.update(double(first + 1) / down, camera.name);
  }
  return image;
}

void Integrator::render(const CameraRays& rays, int x0, int y0, Image& image) const {
  Tile tile{std::vector<Color>(kTile * kTile, Color(0.0f)), {}};
  const std::uint64_t seed = scramble(std::uint64_t(y0) << 32 | std::uint64_t(x0));
  RayPacket packet;
  packet.clear();
  std::array<Path, RayPacket::kSize> paths;
  int lane = 0;
  const int x1 = std::min(x0 + kTile, image.width), y1 = std::min(y0 + kTile, image.height);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const Vec2f shift = pixel_shift(std::size_t(y) * image.width + x);
      for (int k = 0; k < config_.samples; ++k) {
        const Vec2f at = sample_point(k, config_.samples, shift);
        const CameraRay ray = rays(float(x) + at.x, float(y) + at.y);
        packet.set(lane, ray_scene_.to_local(ray.origin), ray.direction);
        paths[lane] = {std::uint32_t((y - y0) * kTile + x - x0), Color(1.0f), 0};
        if (++lane < RayPacket::kSize) continue;
        trace(packet, paths, tile);
        lane = 0;
        if (tile.points.size() > kMostPoints) add_direct_light(tile, seed);
      }
    }
  if (lane > 0) trace(packet, paths, tile);
  add_direct_light(tile, seed);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      image.pixels[std::size_t(y) * image.width + x] = tile.pixels[(y - y0) * kTile + x - x0] / float(config_.samples);
}

void Integrator::add_direct_light(Tile& tile, std::uint64_t seed) const {
  if (lights_) lights_->add(tile.points, kTile, seed, tile.pixels);
  tile.points.clear();
}

void Integrator::trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, Tile& tile) const {
  for (bool coherent = true, going = true; going; coherent = false) {
    ray_scene_.intersect(packet, coherent);
    going = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0) continue;
      if (shade(packet, lane, paths[lane], tile))
        going = true;
      else
        packet.valid[lane] = 0;
    }
  }
}

bool Integrator::shade(RayPacket& packet, int lane, Path& path, Tile& tile) const {
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
  if (scene_.primitives[hit.primitive].texture >= 0)
    reflectance = textured_reflectance(scene_, hit.primitive, hit.u, hit.v);
  if (scene_.primitives[hit.primitive].shader >= 0) apply_shader(hit, reflectance, emission);
  if (!mirror) reflectance += material.specular;
  const Color radiance = (emission + reflectance * irradiance_at(hit, i)) / float(kPi);
  tile.pixels[path.pixel] += path.throughput * radiance;
  const SurfacePoint point = point_of(hit);
  const Vec3d off = point.position + Vec3d(point.normal) * double(ray_scene_.offset(hit.primitive));
  if (lights_)
    tile.points.push_back({path.pixel, hit.primitive, off, normals_(hit.primitive, hit.u, hit.v, point.normal),
                           path.throughput * reflectance / float(kPi)});
  path.throughput *= material.specular;
  if (!mirror || largest(path.throughput) < kLeastThroughput || ++path.mirrors >= kMostMirrors) return false;
  packet.set(lane, ray_scene_.to_local(off), direction - point.normal * (2.0f * (point.normal ^ direction)));
  return true;
}

/// From (u,v), since the ray's own end is only as exact as the ray is long.
SurfacePoint Integrator::point_of(const SurfaceHit& hit) const {
  return point_at(scene_.primitives[hit.primitive], hit.u, hit.v);
}

Color Integrator::irradiance_at(const SurfaceHit& hit, std::int32_t patch) const {
  return display_ ? (*display_)(hit.primitive, patch, hit.u, hit.v) : irradiance_lookup_(hit.primitive, hit.u, hit.v);
}

void Integrator::apply_shader(const SurfaceHit& hit, Color& reflectance, Color& emission) const {
  const Primitive& p = scene_.primitives[hit.primitive];
  MaterialShader& shader = shaders_.local()[p.shader];
  if (shader.reflects()) reflectance = shaded_reflectance(scene_, shader, hit.primitive, hit.u, hit.v);
  if (!shader.emits()) return;
  const ExpressionInputs at = shader_inputs(scene_, hit.primitive, hit.u, hit.v);
  emission = within_range(shader.emission(at), Color(kMostEmission)) * settings_[p.light_group];
}

}  // namespace patchlight
