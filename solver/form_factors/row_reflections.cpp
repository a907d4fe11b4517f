#include <algorithm>

#include "pipeline/optics/surface/mirror.h"
#include "pipeline/optics/transport/mirror_path.h"
#include "solver/form_factors/row_samples.h"

namespace patchlight {

/// Whether coats reflect the ray that hits them, as a facet that the ray meets by chance does: then the ray starts
/// again with a weight of 1, or with that of a tint. Else, `passed` is its weight at the diffuse part.
bool RayRows::reflects_at_coat(const SurfaceHit& hit, std::uint64_t random, int lane, RayPacket& packet,
                               Color& throughput, Color& passed) const {
  const SurfacePoint point = point_at(scene_.primitives[hit.primitive], hit.u, hit.v);
  Vec3f direction = packet.direction(lane);
  const Vec2f at(uniform01(random), uniform01(hash64(random)));
  const SpecularProperties specular = specular_properties_at(scene_, hit.primitive, hit.u, hit.v);
  const auto start_again = [&] {
    packet.set(lane, ray_scene_.to_local(point.position) + point.normal * ray_scene_.offset(hit.primitive), direction);
    return true;
  };
  passed = Color(1.0f);
  if (reflects_at_clear_coat(specular, point.normal, random, direction)) return start_again();
  Color reflected(1.0f);
  if (!reflect(specular, point.normal, at, direction, reflected)) reflected = Color(0.0f);
  const float chance = max_component(reflected);
  if (uniform01(hash64(~random)) >= chance) {
    for (int k = 0; k < 3; ++k) passed[k] = reflected[k] == chance ? 1.0f : (1.0f - reflected[k]) / (1.0f - chance);
    return false;
  }
  for (int k = 0; k < 3; ++k) throughput[k] *= reflected[k] == chance ? 1.0f : reflected[k] / chance;
  return start_again();
}

void RayRows::trace_reflections(SampleSet& set, int first, RayPacket& packet, Reflections& reflections) const {
  std::array<Color, RayPacket::kSize>& throughput = reflections.throughput;
  for (int bounce = 0; bounce < kMaxMirrorBounces; ++bounce) {
    bool any_active = bounce == 0 && reflections.started != 0;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.valid[lane] == 0 || (bounce == 0 && (reflections.started >> lane & 1u))) continue;
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      const Vec3f direction = packet.direction(lane);
      packet.valid[lane] = 0;
      if (packet.passable >> lane & 1u) {
        const std::uint64_t random = hash64(~set.ray_random(first + lane, bounce));
        const bool active = goes_on(cross(set, hit, random, lane, packet, throughput[lane]));
        if (!active) packet.valid[lane] = 0;
        any_active = any_active || active;
        continue;
      }
      if (bounce > 0 && hit.primitive < 0 && scene_.environment)
        set.mirrored.push_back({set.row, set.index, elements_.sky(direction), throughput[lane]});
      if (!hit.front || (bounce == 0 && finish_[hit.primitive] != Finish::specular)) continue;
      const std::uint64_t random = set.ray_random(first + lane, bounce);
      Color passed(1.0f);
      if (finish_[hit.primitive] == Finish::coated &&
          reflects_at_coat(hit, random, lane, packet, throughput[lane], passed)) {
        any_active = true;
        continue;
      }
      if (bounce > 0)
        set.mirrored.push_back(
            {set.row, set.index, elements_.at(hit.primitive, hit.u, hit.v), throughput[lane] * passed});
      if (finish_[hit.primitive] == Finish::specular)
        any_active = continue_at_mirror(scene_, ray_scene_, hit, random, lane, packet, throughput[lane]) || any_active;
    }
    if (!any_active) return;
    ray_scene_.intersect(packet, false);
  }
}

}  // namespace patchlight
