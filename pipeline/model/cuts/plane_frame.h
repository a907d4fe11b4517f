#pragma once
#include <optional>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Cartesian coordinates on the plane of a plane quad or triangle, m, with the origin at its corner 0.
class PlaneFrame {
 public:
  /// The frame of a primitive; none for spheres and for quads that are not plane.
  static std::optional<PlaneFrame> of(const Primitive& primitive);

  const Vec3d& normal() const { return normal_; }
  /// Signed distance of a point in front of the plane, m.
  double height(const Vec3d& p) const { return normal_ ^ (p - origin_); }
  Vec2d to_plane(const Vec3d& p) const { return {along_ ^ (p - origin_), across_ ^ (p - origin_)}; }
  Vec3d to_world(const Vec2d& p) const { return origin_ + along_ * p.x + across_ * p.y; }

 private:
  Vec3d origin_{0.0}, along_{0.0}, across_{0.0}, normal_{0.0};
};

}  // namespace patchlight
