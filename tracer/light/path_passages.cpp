#include <algorithm>
#include <cmath>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/glass.h"
#include "pipeline/optics/surface/mirror.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "tracer/light/path_tracer.h"
#include "tracer/sampling/pixel_samples.h"

namespace patchlight {

namespace {

constexpr std::uint64_t kStream = 0x676c617373;  // of random numbers, apart from those of reflections

float largest(const Color& c) {
  return std::max({c.x, c.y, c.z});
}

}  // namespace

bool PathTracer::pass(const SurfaceHit& hit, const SurfacePoint& point, int lane, Path& path, RayPacket& packet,
                      PathSums& sums) const {
  const Primitive& primitive = scene_.primitives[hit.primitive];
  const Transmission& glass = scene_.materials[primitive.material].transmission;
  const Vec3f in = packet.direction(lane);
  const bool inside = glass.solid && !hit.front;
  const Vec3f facing = (in ^ point.normal) < 0 ? point.normal : -point.normal;
  Vec3f normal = normals_.mapped(hit.primitive, hit.u, hit.v, normals_(hit.primitive, hit.u, hit.v, point.normal));
  if ((normal ^ facing) < 0) normal = -normal;
  normal = valid_for_viewer(normal, facing, -in);
  if (inside) path.throughput *= unabsorbed(glass, hit.t);

  const SpecularProperties specular = specular_properties_at(scene_, hit.primitive, hit.u, hit.v);
  const float cosine = std::min(-(in ^ normal), 1.0f);
  // After a rough surface, whose light of lamps comes straight, by shadow rays.
  const bool is_straight = path.pdf > 0 || (!glass.solid && specular.roughness < kMirrorRoughness);
  const Color reflectance = inside && !is_straight ? glass_reflectance(specular, glass, cosine, true)
                                                   : coats_.at(primitive.material, specular, cosine) + specular.metal;
  Color through = glass.tint * glass.part;
  if (is_colored(scene_, hit.primitive)) through *= base_color(scene_, hit.primitive, hit.u, hit.v);
  const float alpha = primitive.mask >= 0 ? std::min(alpha_at(scene_, hit.primitive, hit.u, hit.v), 1.0f) : 1.0f;
  const float open = 1.0f - alpha, reflected = inside && is_straight ? 0.0f : alpha * largest(reflectance);
  const float passed = alpha * largest((Color(1.0f) - reflectance) * through);
  const float all = open + reflected + passed;
  if (!(all > 0) || ++path.bounces >= kMaxBounces) return false;

  const std::uint64_t seed =
      hash64(hash64(sums.window->pixel_id(path.pixel)) ^ (kStream + std::uint64_t(path.bounces)));
  const Vec2f at = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(seed))), seed);
  const float choice = all * pixel_sample(shuffled(path.sample, std::uint32_t(hash64(~seed))), ~seed).x;
  const auto go_on = [&](const Vec3f& side, const Vec3f& direction) {
    const Vec3d origin = point.position + Vec3d(side) * double(ray_scene_.offset(hit.primitive));
    packet.set(lane, ray_scene_.to_local(origin), direction);
    return largest(path.throughput) >= kMinThroughput;
  };
  if (choice < open) {
    path.throughput *= all;
    return go_on(-facing, in);
  }
  if (choice < open + reflected && !inside) {
    if (!path.faint) path.faint = specular.metal == Color(0.0f) && largest(path.throughput) * reflected < kFaint;
    path.throughput *= alpha * all / reflected;
    const Vec3d origin = point.position + Vec3d(facing) * double(ray_scene_.offset(hit.primitive));
    Vec3f direction = in;
    return scatter(specular, origin, normal, facing, lane, path, direction, sums) && go_on(facing, direction);
  }
  const GlassWays ways = glass_ways(specular, glass, normal, inside, at, in);
  const bool is_reflected = choice < open + reflected;
  path.mirrored = path.mirrored || is_reflected || !is_straight;
  if (is_reflected) {
    path.throughput *= ways.reflected * (alpha * all / reflected);
    return go_on(facing, ways.reflection);
  }
  path.throughput *= is_straight ? (Color(1.0f) - reflectance) * through * (alpha * all / passed)
                                 : ways.passed * through * (alpha * all / passed);
  if (!is_straight && specular.roughness >= kMirrorRoughness) path.scattered = path.features.scattered = true;
  return go_on(-facing, is_straight ? in : ways.passage);
}

}  // namespace patchlight
