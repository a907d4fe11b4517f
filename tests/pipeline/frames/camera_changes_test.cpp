#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/frames/frame_list.h"
#include "pipeline/job/frame_size.h"
#include "tests/expect_error.h"

namespace patchlight {
namespace {

/// A scene with a still camera and one that moves.
PatchSet filmed_scene() {
  PatchSet scene;
  scene.cameras.resize(2);
  scene.cameras[0].name = "still";
  scene.cameras[0].to_world.translate(Vec3d(1, 2, 3));
  scene.cameras[0].vertical = 0.5;
  scene.cameras[0].znear = 1;
  scene.cameras[0].zfar = 9;
  scene.cameras[1].name = "walk";
  scene.cameras[1].motion = {{Motion::Kind::translation, Motion::Interpolation::linear, {0, 10}, {0, 0, 0, 10, 0, 0}}};
  return scene;
}

TEST(CameraChanges, KeepThePlaceAndTheRestOfTheLens) {
  Job job;
  CameraConfig& change = job.cameras["still"];
  change.aperture = 0.02;
  change.focus = 3;
  change.shift = Vec2d(0.1, -0.2);
  change.zfar = 20;
  const Camera camera = job_frames(job, filmed_scene())[0].camera;
  EXPECT_EQ(camera.to_world.translation(), Vec3d(1, 2, 3));
  EXPECT_EQ(camera.vertical, 0.5);
  EXPECT_EQ(camera.aperture, 0.02);
  EXPECT_EQ(camera.focus, 3);
  EXPECT_EQ(camera.shift, Vec2d(0.1, -0.2));
  EXPECT_EQ(camera.znear, 1);
  EXPECT_EQ(camera.zfar, 20);
  change.height = 4;
  EXPECT_EQ(job_frames(job, filmed_scene())[0].camera.projection, Camera::Projection::orthographic);
  EXPECT_EQ(job_frames(job, filmed_scene())[0].camera.vertical, 2);
}

TEST(CameraChanges, KeepTheMotion) {
  Job job;
  job.cameras["walk"].angle = 20;
  job.trace.frames = "24,48";
  const std::vector<Frame> frames = job_frames(job, filmed_scene());
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_DOUBLE_EQ(frames[2].camera.to_world.translation().x, 2);
  EXPECT_DOUBLE_EQ(frames[2].camera.vertical, 20 * kPi / 180);
}

TEST(CameraChanges, OfNoCameraOrToAnImpossibleLensAreRefused) {
  Job job;
  job.file = "job.yaml";
  job.cameras["stil"].znear = 1;
  EXPECT_ERROR(job_frames(job, filmed_scene()), ExitCode::bad_config, "(job.yaml, cameras.stil)");
  job.cameras = {};
  job.cameras["still"].znear = 9;
  EXPECT_ERROR(job_frames(job, filmed_scene()), ExitCode::bad_config, "camera `still`: `znear`");
  job.cameras["still"] = {};
  job.cameras["still"].aperture = 0.1;
  EXPECT_ERROR(job_frames(job, filmed_scene()), ExitCode::bad_config, "without a `focus`");
}

TEST(CameraChanges, ACameraOfTheJobHasAWholeViewAndIsSharpWhereItLooks) {
  Job job;
  CameraConfig& own = job.cameras["still"];
  own.look_from = Vec3d(0, 3, 4);
  own.aperture = 0.1;
  const Camera camera = job_frames(job, filmed_scene())[0].camera;
  EXPECT_EQ(camera.focus, 5);
  EXPECT_EQ(camera.znear, 0);
  EXPECT_TRUE(std::isinf(camera.zfar));
}

TEST(FrameSize, HasTheShapeOfTheCameraAndAboutAsManyPixelsAsTheDefault) {
  Camera camera;
  const auto size = [&](double aspect) {
    camera.aspect = aspect;
    return frame_size({}, camera);
  };
  EXPECT_EQ(size(4.0 / 3), (std::array{640, 480}));
  EXPECT_EQ(size(16.0 / 9), (std::array{736, 414}));
  EXPECT_EQ(size(double(9.0f / 16.0f)), (std::array{414, 736}));
  EXPECT_EQ(size(1), (std::array{554, 554}));
  for (double aspect = 0.05; aspect < 20; aspect *= 1.037) {
    const auto [width, height] = size(aspect);
    EXPECT_EQ(width % 2 + height % 2, 0);
    EXPECT_NEAR(double(width) * height, 640 * 480, 0.06 * 640 * 480) << aspect;
    EXPECT_NEAR(double(width) / height / aspect, 1, 1.0 / std::min(width, height)) << aspect;
  }
  TraceConfig config;
  config.resolution = {30, 20};
  EXPECT_EQ(frame_size(config, camera), (std::array{30, 20}));
}

TEST(FrameSize, IsOfEachFrameAndInItsKey) {
  Job job;
  job.cameras["still"].aspect = 2;
  const std::vector<Frame> frames = job_frames(job, filmed_scene());
  EXPECT_EQ(frames[0].size, (std::array{784, 392}));
  EXPECT_EQ(frames[1].size, (std::array{640, 480}));
}

}  // namespace
}  // namespace patchlight
