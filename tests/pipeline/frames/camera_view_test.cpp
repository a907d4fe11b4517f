#include "pipeline/frames/camera_view.h"

#include <gtest/gtest.h>

#include "pipeline/job/own_camera.h"

namespace patchlight {
namespace {

const Imath::Box3d kUnitBox(Vec3d(-1.0), Vec3d(1.0));

Camera camera(const Vec3d& from, const Vec3d& at, std::optional<double> height = {}) {
  CameraConfig config;
  config.look_from = from;
  config.look_at = at;
  config.height = height;
  return own_camera("camera", config, 1).value();
}

TEST(CameraView, SeesAllFromInside) {
  EXPECT_FALSE(misses(camera({0, 0, 0.5}, {0, 0, 9}), 1, kUnitBox));
}

TEST(CameraView, SeesWhatItLooksAtFromOutside) {
  EXPECT_FALSE(misses(camera({0, 0, 5}, {0, 0, 0}), 1, kUnitBox));
  EXPECT_FALSE(misses(camera({9, 7, 5}, {0, 0, 0}), 1.5, kUnitBox));
  EXPECT_FALSE(misses(camera({0, 0, 5}, {0, 0, 0}, 0.1), 1, kUnitBox));
}

TEST(CameraView, MissesWhatIsBehindOrBesideIt) {
  EXPECT_TRUE(misses(camera({0, 0, 5}, {0, 0, 9}), 1, kUnitBox));
  EXPECT_TRUE(misses(camera({0, 0, 5}, {5, 0, 5}), 1, kUnitBox));
  EXPECT_TRUE(misses(camera({5, 0, 5}, {5, 0, 0}), 1, kUnitBox));
  EXPECT_TRUE(misses(camera({0, 0, 5}, {0, 0, 9}, 10), 1, kUnitBox));
  EXPECT_TRUE(misses(camera({5, 0, 5}, {5, 0, 0}, 2), 1, kUnitBox));
}

TEST(CameraView, IsAsWideAsTheImage) {
  const Camera beside = camera({5, 0, 5}, {5, 0, 0});
  EXPECT_TRUE(misses(beside, 1, kUnitBox));
  EXPECT_FALSE(misses(beside, 4, kUnitBox));
  const Camera parallel = camera({5, 0, 5}, {5, 0, 0}, 3);
  EXPECT_TRUE(misses(parallel, 1, kUnitBox));
  EXPECT_FALSE(misses(parallel, 4, kUnitBox));
}

TEST(CameraView, BoundsHoldQuadsAndSpheres) {
  PatchSet scene;
  scene.primitives.resize(2);
  scene.primitives[0].corners = {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(1, 2, 0), Vec3d(0, 2, 0)};
  scene.primitives[1].shape = Primitive::Shape::sphere;
  scene.primitives[1].sphere_center = Vec3d(0, 0, 3);
  scene.primitives[1].sphere_radius = -0.5;
  EXPECT_EQ(scene_bounds(scene), Imath::Box3d(Vec3d(-0.5, -0.5, 0), Vec3d(1, 2, 3.5)));
}

}  // namespace
}  // namespace patchlight
