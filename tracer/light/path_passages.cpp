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
constexpr std::uint64_t kCoatStream = 0x636c656172;

}  // namespace

void PathTracer::add_part(const SurfaceHit& hit, const Vec3d& position, const Vec3f& facing, const Vec3f& normal,
                          const Vec3f& in, const Color& reflectance, const Path& path, PathSums& sums) const {
  PathSums::Part part{path, ray_scene_.to_local(position) + facing * ray_scene_.offset(hit.primitive),
                      in - normal * (2.0f * (in ^ normal))};
  part.path.throughput *= reflectance;
  part.path.faint = max_component(part.path.whole_throughput()) < kFaint;
  part.path.is_part = true;
  part.path.pdf = 0;
  part.path.turn(SeenBy::coat);
  ++part.path.bounces;
  sums.parts.push_back(part);
}

bool PathTracer::reflects_at_clear_coat(const SurfaceHit& hit, const SurfacePoint& point,
                                        const SpecularProperties& specular, const Vec3f& normal, const Vec3f& in,
                                        Path& path, PathSums& sums) const {
  const float cosine = std::min(-(in ^ normal), 1.0f);
  const SpecularProperties layer = specular.clear_layer(), below = specular.below();
  const float albedo = coats_.at(layer, cosine).x;
  if (path.bounces == 0 && !path.is_part && layer.roughness < kMirrorRoughness) {
    add_part(hit, point.position, point.normal, normal, in, layer.reflectance(cosine), path, sums);
    path.throughput *= 1.0f - albedo;
    return false;
  }
  const float passed = (1.0f - albedo) * max_component(below.metal + coats_.at(below, cosine));
  const float chance = albedo / (albedo + passed);
  const std::uint64_t seed =
      hash64(hash64(sums.window->pixel_id(path.pixel)) ^ (kCoatStream + std::uint64_t(path.bounces)));
  if (pixel_sample(shuffled(path.sample, std::uint32_t(hash64(seed))), seed).x < chance) {
    path.throughput /= chance;
    return true;
  }
  path.throughput *= (1.0f - albedo) / (1.0f - chance);
  return false;
}

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
  const Color reflectance =
      inside ? glass_reflectance(specular, glass, cosine, true) : coats_.at(specular, cosine) + specular.metal;
  Color through = glass.tint * glass.part;
  if (is_colored(scene_, hit.primitive)) through *= base_color(scene_, hit.primitive, hit.u, hit.v);
  const float alpha = primitive.mask >= 0 ? std::min(alpha_at(scene_, hit.primitive, hit.u, hit.v), 1.0f) : 1.0f;
  const float open = 1.0f - alpha, reflected = alpha * max_component(reflectance);
  const float passed = alpha * max_component((Color(1.0f) - reflectance) * through);
  // Both ways from the faces of the first glass, so that faint reflections before what is dark show no grain.
  const bool is_split =
      path.bounces <= 1 && !path.is_part && specular.roughness < kMirrorRoughness && reflected > 0 && open + passed > 0;
  if (is_split) {
    add_part(hit, point.position, facing, normal, in, reflectance * alpha, path, sums);
  }
  const float reflected_here = is_split ? 0.0f : reflected, all = open + reflected_here + passed;
  if (!(all > 0) || ++path.bounces >= kMaxBounces) return false;

  const std::uint64_t seed =
      hash64(hash64(sums.window->pixel_id(path.pixel)) ^ (kStream + std::uint64_t(path.bounces)));
  const Vec2f at = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(seed))), seed);
  const float choice = all * pixel_sample(shuffled(path.sample, std::uint32_t(hash64(~seed))), ~seed).x;
  const auto go_on = [&](const Vec3f& side, const Vec3f& direction) {
    const Vec3d origin = point.position + Vec3d(side) * double(ray_scene_.offset(hit.primitive));
    packet.set(lane, ray_scene_.to_local(origin), direction);
    return max_component(path.whole_throughput()) >= kMinThroughput;
  };
  if (choice < open) {
    path.throughput *= all;
    return go_on(-facing, in);
  }
  if (choice < open + reflected_here && !inside) {
    if (!path.faint)
      path.faint = specular.metal == Color(0.0f) && max_component(path.whole_throughput()) * reflected < kFaint;
    path.throughput *= alpha * all / reflected;
    const Vec3d origin = point.position + Vec3d(facing) * double(ray_scene_.offset(hit.primitive));
    Vec3f direction = in;
    return scatter(specular, hit.primitive, origin, normal, facing, lane, path, direction, sums) &&
           go_on(facing, direction);
  }
  const GlassWays ways = glass_ways(specular, glass, normal, inside, at, in);
  const bool is_reflected = choice < open + reflected_here;
  const bool is_straight = !is_reflected && !glass.solid && specular.roughness < kMirrorRoughness;
  if (!is_straight) path.turn(SeenBy::glass);
  if (is_reflected) {
    path.pdf = 0;  // shadow rays go straight: no MIS
    path.throughput *= ways.reflected * (alpha * all / reflected);
    return go_on(facing, ways.reflection);
  }
  path.throughput *= ways.passed * through * (alpha * all / passed);
  const bool rough = specular.roughness >= kMirrorRoughness;
  if (rough) path.scattered = path.features.scattered = true;
  if (rough || (path.entry.primitive >= 0 && inside &&
                !is_plate(scene_, path.entry, point.normal, hit.t * std::abs(in ^ point.normal))))
    path.pdf = 0;
  path.entry = glass.solid && !inside ? GlassEntry{hit.primitive, point.normal} : GlassEntry{};
  return go_on(-facing, ways.passage);
}

}  // namespace patchlight
