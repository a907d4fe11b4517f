#include "pipeline/model/patch_set.h"

#include <gtest/gtest.h>

namespace patchlight {
namespace {

TEST(PatchSet, BoundsHoldCornersAndSpheres) {
  PatchSet scene;
  scene.primitives.resize(2);
  scene.primitives[0].corners = {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(1, 2, 0), Vec3d(0, 2, 0)};
  scene.primitives[1].shape = Primitive::Shape::sphere;
  scene.primitives[1].sphere_center = Vec3d(0, 0, 3);
  scene.primitives[1].sphere_radius = -0.5;
  EXPECT_EQ(bounds_of(scene.primitives), Imath::Box3d(Vec3d(-0.5, -0.5, 0), Vec3d(1, 2, 3.5)));
}

}  // namespace
}  // namespace patchlight
