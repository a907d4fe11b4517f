#include "solver/direct/photon_targets.h"

#include <ImathBox.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/transport/glass_path.h"

namespace patchlight {

namespace {

constexpr int kMaxSeparatePlanes = 8;       // metallic planes of a node that are separate targets
constexpr double kRadiusMargin = 1 + 1e-6;  // keeps the surfaces inside of their bounding sphere

/// The patch ranges of all primitives, as emitters.
std::vector<Emitter> primitive_surfaces(const PatchSet& scene) {
  std::vector<Emitter> all(scene.primitives.size());
  for (std::int32_t i = 0; i < std::int32_t(scene.patches.size()); ++i) {
    Emitter& surface = all[scene.patches[i].primitive];
    if (surface.patches++ == 0) surface.first_patch = i;
    surface.primitive = scene.patches[i].primitive;
  }
  return all;
}

}  // namespace

PhotonTargets::PhotonTargets(const PatchSet& scene, const RayScene& ray_scene, std::span<const PlaneMirror> imaged)
    : imaged_(int(imaged.size())), target_of_(scene.primitives.size(), -1) {
  const std::vector<Emitter> all = primitive_surfaces(scene);
  for (const PlaneMirror& mirror : imaged) {
    target_of_[mirror.primitive()] = count();
    targets_.push_back({DirectLight(scene, ray_scene, all[mirror.primitive()]), false});
  }
  std::vector<std::vector<std::int32_t>> planes(scene.nodes.size());
  for (std::int32_t i = 0; i < std::int32_t(all.size()); ++i) {
    const Primitive& p = scene.primitives[i];
    const bool is_target = scene.materials[p.material].specular != Color(0.0f) || is_turning(scene, i);
    if (!is_target || all[i].patches == 0 || target_of_[i] >= 0) continue;
    if (p.shape == Primitive::Shape::quad) {
      planes[p.node].push_back(i);
    } else if (p.back >= 0 && p.back < i && target_of_[p.back] >= 0) {
      target_of_[i] = target_of_[p.back];
    } else {
      target_of_[i] = count();
      targets_.push_back({DirectLight(p.sphere_center, kRadiusMargin * std::abs(p.sphere_radius)), true});
    }
  }
  for (const auto& node_planes : planes) {
    if (int(node_planes.size()) <= kMaxSeparatePlanes) {
      for (const std::int32_t i : node_planes) {
        target_of_[i] = count();
        targets_.push_back({DirectLight(scene, ray_scene, all[i]), false});
      }
      continue;
    }
    Imath::Box3d box;
    for (const std::int32_t i : node_planes)
      for (const Vec3d& corner : scene.primitives[i].corners) box.extendBy(corner);
    double radius = 0;
    for (const std::int32_t i : node_planes) {
      target_of_[i] = count();
      for (const Vec3d& corner : scene.primitives[i].corners)
        radius = std::max(radius, (corner - box.center()).length());
    }
    targets_.push_back({DirectLight(box.center(), kRadiusMargin * radius), true});
  }
}

PhotonTargets::Aim PhotonTargets::aim(int target, const SurfacePoint& from, float x, float y) const {
  const auto& [light, is_sphere] = targets_[target];
  if (is_sphere && light.distance(from.position) <= 0) {
    const Vec3f d = cosine_direction(x, y);
    Vec3f tangent, bitangent;
    orthonormal_frame(from.normal, tangent, bitangent);
    return {tangent * d.x + bitangent * d.y + from.normal * d.z, 1.0f};
  }
  const DirectLight::Sample sample = light.sample(from.position, from.normal, x, y);
  return {sample.direction, sample.weight};
}

PhotonTargets::Aim PhotonTargets::aim(int target, const Vec3d& from, float x, float y) const {
  const auto& [light, is_sphere] = targets_[target];
  if (is_sphere && light.distance(from) <= 0) {
    const float z = 1 - 2 * x, radius = std::sqrt(std::max(0.0f, 1 - z * z)), turn = float(2 * kPi) * y;
    return {Vec3f(radius * std::cos(turn), radius * std::sin(turn), z), float(4 * kPi)};
  }
  // Exactly one of two opposite hemispheres contains the sample.
  for (const float up : {1.0f, -1.0f}) {
    const Vec3f axis(0.0f, up, 0.0f);
    const DirectLight::Sample sample = light.sample(from, axis, x, y);
    if (sample.weight > 0) return {sample.direction, float(kPi) * sample.weight / (sample.direction ^ axis)};
  }
  return {Vec3f(0.0f, 1.0f, 0.0f), 0.0f};
}

PhotonTargets::BoundingSphere PhotonTargets::bounding_sphere(int target) const {
  return {targets_[target].light.center(), targets_[target].light.radius()};
}

}  // namespace patchlight
