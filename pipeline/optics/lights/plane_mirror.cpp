#include "pipeline/optics/lights/plane_mirror.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/surface/mirror.h"

namespace patchlight {

namespace {

Vec3d normal_of(const std::array<Vec3d, 4>& corners) {
  return ((corners[2] - corners[0]) % (corners[3] - corners[1])).normalized();
}

bool is_plane_mirror(const PatchSet& scene, std::int32_t i) {
  const Primitive& p = scene.primitives[i];
  const Material& material = scene.materials[p.material];
  if (p.shape != Primitive::Shape::quad || p.mask >= 0 || has_varying_metal(scene, i)) return false;
  if (material.specular == Color(0.0f) || material.roughness >= kMirrorRoughness || material.clear_coat.exists())
    return false;
  constexpr double kFlat = 1e-6;  // largest distance of corners from their plane, relative to the size
  const auto& c = p.corners;
  return std::abs((c[1] - c[0]) ^ normal_of(c)) <= kFlat * (c[2] - c[0]).length();
}

double area_of(const Primitive& p) {
  return 0.5 * ((p.corners[2] - p.corners[0]) % (p.corners[3] - p.corners[1])).length();
}

}  // namespace

PlaneMirror::PlaneMirror(const PatchSet& scene, const RayScene& ray_scene, std::int32_t i)
    : primitive_(i),
      specular_(scene.materials[scene.primitives[i].material].specular),
      corners_(scene.primitives[i].corners),
      normal_(normal_of(corners_)),
      offset_(ray_scene.offset(i)) {}

std::optional<PlaneMirror::Crossing> PlaneMirror::crossing(const Vec3d& start, const Vec3f& direction) const {
  const Vec3d along(direction);
  const double above = height(start), slope = -(along ^ normal_);
  if (above <= offset_ || slope <= 0) return std::nullopt;
  const double distance = above / slope, gap = offset_ / slope;
  const Vec3d at = start + along * distance, reflected = reflect(along);
  for (int k = 0; k < 4; ++k)
    if ((((corners_[(k + 1) % 4] - corners_[k]) % (at - corners_[k])) ^ normal_) < 0) return std::nullopt;
  return Crossing{float(distance - gap), float(distance + gap), at + reflected * gap, Vec3f(reflected)};
}

bool PlaneMirror::is_behind(std::span<const Vec3d> corners) const {
  return std::none_of(corners.begin(), corners.end(), [&](const Vec3d& corner) { return height(corner) > offset_; });
}

std::vector<PlaneMirror> plane_mirrors(const PatchSet& scene, const RayScene& ray_scene) {
  std::vector<std::int32_t> found;
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i)
    if (is_plane_mirror(scene, i)) found.push_back(i);
  std::stable_sort(found.begin(), found.end(), [&](std::int32_t a, std::int32_t b) {
    return area_of(scene.primitives[a]) > area_of(scene.primitives[b]);
  });
  std::vector<PlaneMirror> mirrors;
  for (std::size_t k = 0; k < std::min(found.size(), kMaxPlaneMirrors); ++k)
    mirrors.emplace_back(scene, ray_scene, found[k]);
  return mirrors;
}

}  // namespace patchlight
