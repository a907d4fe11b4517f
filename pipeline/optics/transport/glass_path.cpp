#include "pipeline/optics/transport/glass_path.h"

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/glass.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "pipeline/optics/transport/mirror_path.h"

namespace patchlight {

namespace {

constexpr int kMostPassed = 256;  // surfaces that a straight ray passes

}  // namespace

Passing cross_by_chance(const PatchSet& scene, const RayScene& ray_scene, const SurfaceHit& hit, std::uint64_t random,
                        int lane, RayPacket& packet, Color& throughput) {
  const Primitive& primitive = scene.primitives[hit.primitive];
  const Transmission& glass = scene.materials[primitive.material].transmission;
  const SurfacePoint point = point_at(primitive, hit.u, hit.v);
  const Vec3f direction = packet.direction(lane);
  const Vec3f normal = (direction ^ point.normal) < 0 ? point.normal : -point.normal;
  const auto go_on = [&](const Vec3f& side, const Vec3f& along) {
    packet.set(lane, ray_scene.to_local(point.position) + side * ray_scene.offset(hit.primitive), along);
  };
  if (primitive.mask >= 0 && uniform01(hash64(random + 1)) >= alpha_at(scene, hit.primitive, hit.u, hit.v)) {
    go_on(-normal, direction);
    return Passing::open;
  }
  const SpecularProperties specular = specular_properties_at(scene, hit.primitive, hit.u, hit.v);
  if (!glass.exists() && specular.is_black()) return Passing::lands;
  const bool inside = glass.solid && !hit.front;
  if (inside) throughput *= unabsorbed(glass, hit.t);
  const Vec2f at(uniform01(random), uniform01(hash64(random)));
  const GlassWays ways = glass_ways(specular, glass, normal, inside, at, direction);
  const float chance = max_component(ways.reflected);
  if (uniform01(hash64(~random)) < chance) {
    throughput *= ways.reflected / chance;
    go_on(normal, ways.reflection);
    return Passing::reflected;
  }
  if (uniform01(hash64(~hash64(random))) >= glass.part) {
    throughput *= (Color(1.0f) - ways.reflected) / (1.0f - chance);
    return Passing::lands;
  }
  throughput *= ways.passed / (1.0f - chance) * glass.tint;
  if (is_colored(scene, hit.primitive)) throughput *= base_color(scene, hit.primitive, hit.u, hit.v);
  if (!survives_roulette(hash64(random + 2), throughput)) return Passing::ends;
  go_on(-normal, ways.passage);
  return Passing::passed;
}

void pass_straight(const PatchSet& scene, const RayScene& ray_scene, RayPacket& packet, std::span<Color> throughput,
                   bool all) {
  RayPacket rays = packet;
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    if (!(rays.passable >> lane & 1u)) rays.valid[lane] = 0;
  bool any = rays.passable != 0;
  for (int passed = 0; any && passed < kMostPassed; ++passed) {
    any = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (rays.valid[lane] == 0) continue;
      const SurfaceHit hit = ray_scene.hit(rays, lane);
      if (!(rays.passable >> lane & 1u) || (!all && is_turning(scene, hit.primitive))) {
        packet.copy_lane(rays, lane);
        rays.valid[lane] = 0;
        continue;
      }
      const SurfacePoint point = point_at(scene.primitives[hit.primitive], hit.u, hit.v);
      const Vec3f direction = rays.direction(lane);
      const Vec3f side = (direction ^ point.normal) < 0 ? -point.normal : point.normal;
      if (!throughput.empty()) throughput[lane] *= straight_transmittance(scene, hit, direction);
      rays.set(lane, ray_scene.to_local(point.position) + side * ray_scene.offset(hit.primitive), direction);
      any = true;
    }
    if (any) ray_scene.intersect(rays, false);
  }
}

}  // namespace patchlight
