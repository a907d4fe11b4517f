#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight::test {

inline Primitive quad(const std::array<Vec3d, 4>& corners) {
  Primitive primitive;
  primitive.corners = corners;
  return primitive;
}

inline Primitive sphere(double radius) {
  Primitive primitive;
  primitive.shape = Primitive::Shape::sphere;
  primitive.sphere_center = {1, 2, 3};
  primitive.sphere_radius = radius;
  return primitive;
}

inline const Primitive kRectangle = quad({{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {0, 1, 0}}});
inline const Primitive kTrapezoid = quad({{{0, 0, 0}, {4, 0, 0}, {3, 2, 0}, {1, 2, 0}}});
inline const Primitive kTriangle = quad({{{0, 0, 0}, {4, 0, 0}, {1, 3, 0}, {1, 3, 0}}});

}  // namespace patchlight::test
