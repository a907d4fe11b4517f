#include "solver/direct/photon_source.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/elements.h"

namespace patchlight {

namespace {

constexpr double kPatchSizes = 1e3;  // bounds the extent of a patch, slivers included

}  // namespace

PhotonSource::PhotonSource(const PatchSet& scene, const RayScene& ray_scene, const Emitter& emitter, std::uint64_t seed)
    : random(hash64(seed ^ hash64(std::uint64_t(emitter.first_patch + emitter.light + 1)))),
      area(emitter.light < 0 ? emitter.area : 1.0),
      ray_scene_(ray_scene),
      surface_(emitter.light < 0),
      offset_(surface_ ? ray_scene.offset(emitter.primitive) : 0.0f) {
  if (surface_) {
    const Patch& first = scene.patches[emitter.first_patch];
    surface_patch_ = emitter.patches == 1 ? first : sub_patch(scene, first, 0, 0, 1, 1);
    sampler_.emplace(scene.primitives, surface_patch_);
    return;
  }
  light_ = scene.lights[emitter.light];
  direct_light_.emplace(scene, ray_scene, emitter);
  for (const Patch& patch : scene.patches)
    scene_start_ = std::min(scene_start_, (patch.center ^ light_.direction) - std::sqrt(patch.area) * kPatchSizes);
}

PhotonSource::Start PhotonSource::start(const PhotonTargets& targets, int target, const Vec2f& from, float x,
                                        float y) const {
  if (surface_) {
    const SurfacePoint point = (*sampler_)(from.x, from.y);
    const PhotonTargets::Aim aim = targets.aim(target, point, x, y);
    return {ray_scene_.to_local(point.position) + point.normal * offset_, aim.direction, aim.weight};
  }
  if (light_.kind == Light::Kind::sun) {
    // From a disk as large as the target, placed before the whole scene as the sun sees it.
    const auto [center, radius] = targets.bounding_sphere(target);
    Vec3f tangent, bitangent;
    orthonormal_frame(Vec3f(light_.direction), tangent, bitangent);
    const double r = radius * std::sqrt(from.x), turn = 2 * kPi * from.y;
    Vec3d origin = center + Vec3d(tangent) * (r * std::cos(turn)) + Vec3d(bitangent) * (r * std::sin(turn));
    origin += light_.direction * (scene_start_ - (origin ^ light_.direction));
    return {ray_scene_.to_local(origin), Vec3f(light_.direction), float(kPi * radius * radius)};
  }
  if (light_.radius > 0) return start_on_ball(targets, target, from, x, y);
  const PhotonTargets::Aim aim = targets.aim(target, light_.position, x, y);
  const double strength = direct_light_->perpendicular_factor(light_.position + Vec3d(aim.direction));
  return {ray_scene_.to_local(light_.position), aim.direction, float(aim.weight * strength)};
}

/// From the surface of a light with a radius.
PhotonSource::Start PhotonSource::start_on_ball(const PhotonTargets& targets, int target, const Vec2f& from, float x,
                                                float y) const {
  const double z = 1 - 2 * double(from.x), sine = std::sqrt(std::max(0.0, 1 - z * z)), turn = 2 * kPi * from.y;
  const Vec3d normal(sine * std::cos(turn), sine * std::sin(turn), z);
  const Vec3d origin = light_.position + normal * light_.radius;
  const PhotonTargets::Aim aim = targets.aim(target, SurfacePoint{origin, Vec3f(normal)}, x, y);
  if (!(aim.weight > 0)) return {};
  const double part = direct_light_->relative_intensity(Vec3d(aim.direction));
  return {ray_scene_.to_local(origin), aim.direction, float(4 * kPi * double(aim.weight) * part)};
}

}  // namespace patchlight
