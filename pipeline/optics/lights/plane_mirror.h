#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

/// A plane that reflects like a perfect mirror, in one colour. What it shows lies at virtual images.
class PlaneMirror {
 public:
  /// For a planar quad, primitive `i` of the scene.
  PlaneMirror(const PatchSet& scene, const RayScene& ray_scene, std::int32_t i);

  std::int32_t primitive() const { return primitive_; }
  const Color& specular() const { return specular_; }

  Vec3d image_of(const Vec3d& point) const { return point - normal_ * (2 * height(point)); }
  Vec3d reflect(const Vec3d& direction) const { return direction - normal_ * (2 * (direction ^ normal_)); }

  /// A ray that the mirror reflects, with parts left out at the mirror that are within rounding of it.
  struct Crossing {
    float arrives;    ///< Distance from the start to just before the mirror, m.
    float leaves;     ///< Distance from the start, along the ray, to just after the mirror, m.
    Vec3d position;   ///< Where the reflected ray leaves.
    Vec3f direction;  ///< Of the reflected ray, of unit length.
  };

  /// Where a ray from `start` in a direction of unit length meets the front, if nothing else is in the way.
  std::optional<Crossing> crossing(const Vec3d& start, const Vec3f& direction) const;

  /// Whether a point is in front.
  bool is_before(const Vec3d& point) const { return height(point) > offset_; }

  /// Whether no point of a planar surface with these corners is in front.
  bool is_behind(std::span<const Vec3d> corners) const;

 private:
  double height(const Vec3d& point) const { return (point - corners_[0]) ^ normal_; }

  std::int32_t primitive_;
  Color specular_;
  std::array<Vec3d, 4> corners_;
  Vec3d normal_;
  double offset_;  ///< Distance from the plane at which rays end and start, m.
};

/// The largest planes of a scene that are perfect mirrors of one colour without holes, at most kMaxPlaneMirrors.
std::vector<PlaneMirror> plane_mirrors(const PatchSet& scene, const RayScene& ray_scene);
inline constexpr std::size_t kMaxPlaneMirrors = 8;

}  // namespace patchlight
