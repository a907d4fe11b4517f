#include "pipeline/optics/transport/mirror_path.h"

#include <algorithm>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/mirror.h"

namespace patchlight {

bool survives_roulette(std::uint64_t random, Color& throughput) {
  constexpr float kThreshold = 0.25f;
  const float max_channel = max_component(throughput);
  if (max_channel >= kThreshold) return true;
  if (uniform01(hash64(~random)) * kThreshold >= max_channel) return false;
  throughput *= kThreshold / max_channel;
  return true;
}

bool reflects_at_clear_coat(const SpecularProperties& specular, const Vec3f& normal, std::uint64_t random,
                            Vec3f& direction) {
  if (!specular.clear_coat.exists()) return false;
  const std::uint64_t facet = hash64(random ^ 0x636c656172);
  const Vec2f at(uniform01(facet), uniform01(hash64(facet)));
  Vec3f reflection = direction;
  Color reflected(1.0f);
  if (!reflect(specular.clear_layer(), normal, at, reflection, reflected)) return false;
  if (uniform01(hash64(~facet)) >= reflected.x) return false;
  direction = reflection;
  return true;
}

bool continue_at_mirror(const PatchSet& scene, const RayScene& ray_scene, const SurfaceHit& hit, std::uint64_t random,
                        int lane, RayPacket& packet, Color& throughput) {
  const Primitive& primitive = scene.primitives[hit.primitive];
  const SurfacePoint point = point_at(primitive, hit.u, hit.v);
  Vec3f direction = packet.direction(lane);
  const Vec2f at(uniform01(random), uniform01(hash64(random)));
  const SpecularProperties specular = specular_properties_at(scene, hit.primitive, hit.u, hit.v);
  if (!reflects_at_clear_coat(specular, point.normal, random, direction) &&
      (!reflect(specular, point.normal, at, direction, throughput) || !survives_roulette(random, throughput)))
    return false;
  packet.set(lane, ray_scene.to_local(point.position) + point.normal * ray_scene.offset(hit.primitive), direction);
  return true;
}

}  // namespace patchlight
