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

TEST(CameraView, IsShifted) {
  Camera beside = camera({5, 0, 5}, {5, 0, 0});
  beside.shift.x = -0.9;
  EXPECT_FALSE(misses(beside, 1, kUnitBox)) << "the box is on the left";
  beside.shift.x = 0.9;
  EXPECT_TRUE(misses(beside, 4, kUnitBox));
  Camera below = camera({0, -5, 5}, {0, -5, 0}, 3);
  EXPECT_TRUE(misses(below, 1, kUnitBox));
  below.shift.y = 1.2;
  EXPECT_FALSE(misses(below, 1, kUnitBox));
}

TEST(CameraView, EndsAtItsClipPlanes) {
  Camera clipped = camera({0, 0, 5}, {0, 0, 0});
  clipped.znear = 5.9;
  EXPECT_FALSE(misses(clipped, 1, kUnitBox));
  clipped.znear = 6.1;
  EXPECT_TRUE(misses(clipped, 1, kUnitBox));
  clipped.znear = 0;
  clipped.zfar = 4.1;
  EXPECT_FALSE(misses(clipped, 1, kUnitBox));
  clipped.zfar = 3.9;
  EXPECT_TRUE(misses(clipped, 1, kUnitBox));
}

TEST(CameraView, IsWiderThroughALens) {
  for (const std::optional<double> height : {std::optional<double>(), std::optional<double>(3)}) {
    Camera beside = camera({5, 0, 5}, {5, 0, 0}, height);
    EXPECT_TRUE(misses(beside, 1, kUnitBox));
    beside.aperture = 10;  // from x = 0 to 10
    EXPECT_FALSE(misses(beside, 1, kUnitBox));
  }
}

}  // namespace
}  // namespace patchlight
