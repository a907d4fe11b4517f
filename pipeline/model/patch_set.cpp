#include "pipeline/model/patch_set.h"

#include <cmath>

namespace patchlight {

std::vector<bool> facets_of_clusters(const PatchSet& scene) {
  std::vector<bool> is_facet(scene.primitives.size());
  for (const Patch& patch : scene.patches)
    for (std::int32_t k = 0; k < patch.facets; ++k) is_facet[patch.primitive + k] = true;
  return is_facet;
}

Vec3d position_at(const std::array<Vec3d, 4>& c, double u, double v) {
  return (c[0] * (1 - u) + c[1] * u) * (1 - v) + (c[3] * (1 - u) + c[2] * u) * v;
}

Imath::Box3d bounds_of(const std::vector<Primitive>& primitives) {
  Imath::Box3d box;
  for (const Primitive& primitive : primitives) {
    if (primitive.shape == Primitive::Shape::sphere) {
      const Vec3d extent(std::abs(primitive.sphere_radius));
      box.extendBy(primitive.sphere_center - extent);
      box.extendBy(primitive.sphere_center + extent);
    } else if (primitive.region) {
      for (const auto& piece : primitive.region->pieces)
        for (const Vec2d& at : piece) box.extendBy(position_at(primitive.corners, at.x, at.y));
    } else {
      for (const Vec3d& corner : primitive.corners) box.extendBy(corner);
    }
  }
  return box;
}

}  // namespace patchlight
