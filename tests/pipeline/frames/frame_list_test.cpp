#include "pipeline/frames/frame_list.h"

#include <gtest/gtest.h>

#include "tests/expect_error.h"

namespace patchlight {
namespace {

std::vector<std::string> files(const std::vector<std::string>& cameras) {
  PatchSet scene;
  for (const auto& name : cameras) scene.cameras.emplace_back().name = name;
  std::vector<std::string> names;
  for (const Frame& frame : job_frames({}, scene)) names.push_back(frame.exr.filename().string());
  return names;
}

TEST(FrameList, ReplacesACharacterByOneUnderscore) {
  EXPECT_EQ(files({"a b/c", "K\u00fcche \u2603\U0001f4a1", "\xbf\xc3x"}),
            (std::vector<std::string>{"a_b_c.0001.exr", "K_che___.0001.exr", "__x.0001.exr"}));
}

TEST(FrameList, MakesNamesUnique) {
  EXPECT_EQ(files({"a b", "a_b", "a/b"}),
            (std::vector<std::string>{"a_b.0001.exr", "a_b_2.0001.exr", "a_b_3.0001.exr"}));
}

TEST(FrameList, TruncatesLongNames) {
  EXPECT_EQ(files({std::string(243, 'x')})[0].size(), 252u);
  const std::vector<std::string> cut = files({std::string(244, 'x'), std::string(300, 'x')});
  const std::string first(243, 'x'), second(241, 'x');
  EXPECT_EQ(cut[0], first + ".0001.exr");
  EXPECT_EQ(cut[1], second + "_2.0001.exr");
}

/// A scene with a camera `still` and one `walk`, which moves along X at 1 m/s from 0 to 10 s.
PatchSet walkthrough_scene() {
  PatchSet scene;
  scene.cameras.resize(2);
  scene.cameras[0].name = "still";
  scene.cameras[1].name = "walk";
  scene.cameras[1].motion = {{Motion::Kind::translation, Motion::Interpolation::linear, {0, 10}, {0, 0, 0, 10, 0, 0}}};
  return scene;
}

TEST(FrameList, HasOneFrameOfAStaticCamera) {
  Job job;
  job.trace.frames = "12,24..48:24";
  const std::vector<Frame> frames = job_frames(job, walkthrough_scene());
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames[0].exr.filename(), "still.0001.exr");
  EXPECT_EQ(frames[1].exr.filename(), "walk.0012.exr");
  EXPECT_EQ(frames[3].png.filename(), "walk.0048.png");
  EXPECT_DOUBLE_EQ(frames[1].camera.to_world.translation().x, 0.5);
  EXPECT_DOUBLE_EQ(frames[3].camera.to_world.translation().x, 2.0);
  job.trace.fps = 12;
  EXPECT_DOUBLE_EQ(job_frames(job, walkthrough_scene())[1].camera.to_world.translation().x, 1.0);
}

TEST(FrameList, IsBounded) {
  Job job;
  job.trace.frames = "1-60000";
  PatchSet scene = walkthrough_scene();
  EXPECT_EQ(job_frames(job, scene).size(), 60001u);
  scene.cameras.push_back(scene.cameras[1]);
  EXPECT_ERROR(job_frames(job, scene), ExitCode::over_limit, "trace.frames");
}

TEST(FrameList, NamesTheFrameOfADegenerateCamera) {
  Job job;
  PatchSet scene = walkthrough_scene();
  scene.cameras[1].motion[0] = {Motion::Kind::scale, Motion::Interpolation::step, {0}, {0, 0, 0}};
  EXPECT_ERROR(job_frames(job, scene), ExitCode::bad_data, "camera `walk` has a degenerate transform at frame 1");
}

TEST(FrameList, IncludesTheCamerasOfTheJob) {
  Job job;
  job.cameras["walk"].look_from = Vec3d(0, 0, 5);
  job.cameras["above"] = {Vec3d(1, 9, 1), Vec3d(1, 2, 1), Vec3d(0, 0, -1), {}, 3.0};
  const std::vector<Frame> frames = job_frames(job, walkthrough_scene());
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[1].exr.filename(), "walk.0001.exr") << "replaces the scene's camera";
  EXPECT_EQ(frames[1].camera.to_world.translation(), Vec3d(0, 0, 5));
  EXPECT_NEAR(frames[1].camera.vertical, 40 * kPi / 180, 1e-12);
  const Camera& above = frames[2].camera;
  EXPECT_EQ(above.name, "above");
  EXPECT_EQ(above.projection, Camera::Projection::orthographic);
  EXPECT_EQ(above.vertical, 1.5);
  Vec3d forward, up;
  above.to_world.multDirMatrix(Vec3d(0, 0, -1), forward);
  above.to_world.multDirMatrix(Vec3d(0, 1, 0), up);
  EXPECT_TRUE(forward.equalWithAbsError(Vec3d(0, -1, 0), 1e-12));
  EXPECT_TRUE(up.equalWithAbsError(Vec3d(0, 0, -1), 1e-12));
  job.trace.cameras = {"above"};
  EXPECT_EQ(job_frames(job, walkthrough_scene()).size(), 1u);
  job.trace.cameras = {"below"};
  EXPECT_ERROR(job_frames(job, walkthrough_scene()), ExitCode::bad_config, "still, walk, above");
}

TEST(FrameList, RotatesATurntableAboutItsTarget) {
  Job job;
  job.cameras["spin"] = {Vec3d(1, 2, 6), Vec3d(1, 0, 1), Vec3d(0, 1, 0), {}, {}, 8};
  job.trace.cameras = {"spin"};
  job.trace.frames = "1-9";
  const std::vector<Frame> frames = job_frames(job, walkthrough_scene());
  ASSERT_EQ(frames.size(), 9u);
  const auto at = [&](int frame) { return frames[frame - 1].camera.to_world.translation(); };
  EXPECT_TRUE(at(1).equalWithAbsError(Vec3d(1, 2, 6), 1e-12));
  EXPECT_TRUE(at(3).equalWithAbsError(Vec3d(6, 2, 1), 1e-12)) << "right-handed about Y";
  EXPECT_TRUE(at(5).equalWithAbsError(Vec3d(1, 2, -4), 1e-12));
  EXPECT_EQ(frames[8].camera.to_world, frames[0].camera.to_world);
  for (const Frame& frame : frames) {
    Vec3d target;
    frame.camera.to_world.inverse().multVecMatrix(Vec3d(1, 0, 1), target);
    EXPECT_TRUE(target.equalWithAbsError(Vec3d(0, 0, -std::sqrt(29.0)), 1e-9)) << frame.number;
  }
  job.cameras["spin"].turntable = -8;
  EXPECT_TRUE(
      job_frames(job, walkthrough_scene())[2].camera.to_world.translation().equalWithAbsError(Vec3d(-4, 2, 1), 1e-12));
}

}  // namespace
}  // namespace patchlight
