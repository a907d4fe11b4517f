#include <algorithm>

#include "pipeline/optics/transport/mirror_path.h"
#include "solver/form_factors/coated_rows.h"
#include "solver/form_factors/row_samples.h"

namespace patchlight {

namespace {

constexpr float kStraight = 1e-6f;  // of the square of the change of direction, for a ray that left parallel faces

}  // namespace

/// Chooses what a ray does at a surface that lets light pass, and adds the element on which it ends, or which also
/// emits or is partly metallic.
Passing RayRows::cross(SampleSet& set, const SurfaceHit& hit, std::uint64_t random, int lane, RayPacket& packet,
                       Color& throughput) const {
  const Color before = throughput;
  const Passing passing = cross_by_chance(scene_, ray_scene_, hit, random, lane, packet, throughput);
  if (passing == Passing::open || !hit.front) return passing;
  const bool by_chance = passes_by_chance(scene_, scene_.primitives[hit.primitive]);
  if (by_chance && passing != Passing::lands) return passing;
  const std::int32_t element = elements_.at(hit.primitive, hit.u, hit.v);
  const Color weight = by_chance ? throughput : before;
  if (weight == Color(1.0f))
    set.columns.push_back(element);
  else
    set.mirrored.push_back({set.row, set.index, element, weight});
  return passing;
}

/// Continues the rays of a packet that hit surfaces which let light pass. A ray that keeps its direction and its weight
/// counts as if there were no such surface; any other ray is traced on as a reflected one.
void RayRows::pass_surfaces(SampleSet& set, const DirectionTable& table, int first, RayPacket& packet,
                            Reflections& reflections) const {
  RayPacket rays = packet;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const bool passes = packet.passable >> lane & 1u;
    (passes ? packet : rays).valid[lane] = 0;
  }
  const auto start_again = [&](int lane) {
    packet.set(lane, rays.origin(lane), rays.direction(lane));
    reflections.started |= 1u << lane;
    rays.valid[lane] = 0;
  };
  bool any = true;
  for (int bounce = 0; any && bounce < kMaxMirrorBounces; ++bounce) {
    any = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (rays.valid[lane] == 0) continue;
      Color& throughput = reflections.throughput[lane];
      const bool is_straight =
          throughput == Color(1.0f) && (rays.direction(lane) - packet.direction(lane)).length2() < kStraight;
      if (!(rays.passable >> lane & 1u)) {
        if (is_straight) {
          packet.copy_lane(rays, lane);
          meet(set, table, first, lane, packet, reflections);
          rays.valid[lane] = 0;
        } else {
          start_again(lane);
        }
        continue;
      }
      const SurfaceHit hit = ray_scene_.hit(rays, lane);
      const Passing passing = cross(set, hit, set.ray_random(first + lane, bounce), lane, rays, throughput);
      if (passing == Passing::reflected)
        start_again(lane);
      else if (goes_on(passing))
        any = true;
      else
        rays.valid[lane] = 0;
    }
    if (any) ray_scene_.intersect(rays, false);
  }
}

/// The lanes that reach the environment without a change of their directions or colours, a bit each.
std::uint32_t RayRows::reaching_sky(const SampleSet& set, int first, RayPacket& packet) const {
  const std::uint32_t unoccluded = ~ray_scene_.occluded(packet) & ((1u << RayPacket::kSize) - 1);
  if (!ray_scene_.has_passable() || unoccluded == 0) return unoccluded;
  RayPacket rays = packet;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    if (unoccluded >> lane & 1u)
      rays.set(lane, packet.origin(lane), packet.direction(lane));
    else
      rays.valid[lane] = 0;
  }
  std::uint32_t reaching = 0;
  std::array<Color, RayPacket::kSize> throughput;
  throughput.fill(Color(1.0f));
  bool any = true;
  for (int bounce = 0; any && bounce < kMaxMirrorBounces; ++bounce) {
    ray_scene_.intersect(rays, false);
    any = false;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (rays.valid[lane] == 0) continue;
      const SurfaceHit hit = ray_scene_.hit(rays, lane);
      const bool is_straight = (rays.direction(lane) - packet.direction(lane)).length2() < kStraight;
      const bool is_passable = rays.passable >> lane & 1u;
      if (hit.primitive < 0 && is_straight && throughput[lane] == Color(1.0f)) reaching |= 1u << lane;
      Passing passing = Passing::lands;
      if (is_passable)
        passing = cross_by_chance(scene_, ray_scene_, hit, set.ray_random(first + lane, bounce), lane, rays,
                                  throughput[lane]);
      if (passing == Passing::open || passing == Passing::passed)
        any = true;
      else
        rays.valid[lane] = 0;
    }
  }
  return reaching;
}

}  // namespace patchlight
