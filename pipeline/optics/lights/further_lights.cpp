#include "pipeline/optics/lights/further_lights.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/quad_shape.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {

namespace {

std::vector<DirectLight> lights_of(const PatchSet& scene, const RayScene& ray_scene,
                                   const std::vector<Emitter>& emitters) {
  std::vector<DirectLight> lights;
  lights.reserve(emitters.size());
  for (const Emitter& emitter : emitters) lights.emplace_back(scene, ray_scene, emitter);
  return lights;
}

LightTree tree_of(const std::vector<DirectLight>& lights, std::span<const float> strengths) {
  std::vector<LightBounds> bounds;
  bounds.reserve(lights.size());
  for (const DirectLight& light : lights) bounds.push_back(light.bounds());
  for (std::size_t k = 0; k < strengths.size(); ++k) bounds[k].area *= double(strengths[k]);
  return LightTree(bounds);
}

/// (u,v) of a position on a primitive.
Vec2f uv_at(const Primitive& p, const Vec3d& position) {
  if (p.shape == Primitive::Shape::sphere) return sphere_uv(Vec3f(position - p.sphere_center));
  const Vec3d e1 = p.corners[1] - p.corners[0], e3 = p.corners[3] - p.corners[0], at = position - p.corners[0];
  const Vec3d normal = e1 % e3;
  const double scale = 1 / normal.length2();
  const Vec2f shape = quad_shape(p.corners);
  return inverse_bilinear(shape.x, shape.y, float(((at % e3) ^ normal) * scale), float(((e1 % at) ^ normal) * scale));
}

}  // namespace

FurtherLights::FurtherLights(const PatchSet& scene, const RayScene& ray_scene, std::vector<Emitter> emitters,
                             std::span<const float> strengths)
    : scene_(scene),
      emitters_(std::move(emitters)),
      lights_(lights_of(scene, ray_scene, emitters_)),
      tree_(tree_of(lights_, strengths)) {
  const auto has_several = [](const Emitter& emitter) { return emitter.patches > 1; };
  if (std::any_of(emitters_.begin(), emitters_.end(), has_several)) lookup_.emplace(scene);
}

std::int32_t FurtherLights::patch_at(std::int32_t i, const Vec3d& start, const DirectLight::Sample& ray) const {
  const Emitter& emitter = emitters_[i];
  const Primitive& p = scene_.primitives[emitter.primitive];
  if (emitter.patches == 1 && p.mask < 0) return emitter.first_patch;
  const Vec2f uv = uv_at(p, start + Vec3d(ray.direction) * double(ray.distance));
  const auto chance = [&] { return uniform01(hash64(std::bit_cast<std::uint64_t>(ray.direction.x + start.z))); };
  if (p.mask >= 0 && !passes_alpha_test(scene_, emitter.primitive, uv.x, uv.y, chance())) return -1;
  return emitter.patches == 1 ? emitter.first_patch : lookup_->patch(emitter.primitive, uv.x, uv.y);
}

}  // namespace patchlight
