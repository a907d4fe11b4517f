#include "pipeline/model/patch_set.h"

#include <cmath>

namespace patchlight {

Imath::Box3d bounds_of(const std::vector<Primitive>& primitives) {
  Imath::Box3d box;
  for (const Primitive& primitive : primitives) {
    if (primitive.shape == Primitive::Shape::sphere) {
      const Vec3d extent(std::abs(primitive.sphere_radius));
      box.extendBy(primitive.sphere_center - extent);
      box.extendBy(primitive.sphere_center + extent);
    } else {
      for (const Vec3d& corner : primitive.corners) box.extendBy(corner);
    }
  }
  return box;
}

}  // namespace patchlight
