#include "tracer/output/errors_in_view.h"

#include <gmock/gmock.h>

#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

/// A floor of 8 x 8 patches that a camera looks down on, all of it in view.
Solved floor_in_view() {
  PatchScene builder;
  builder.quad({{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}}, 8, 8, {0.5f});
  Solved solved(builder);  // reflects 1.5 W/m2
  solved.camera.name = "above";
  solved.camera.to_world.rotate(Vec3d(-0.5 * kPi, 0, 0));
  solved.camera.to_world.x[3][1] = 2;
  solved.camera.vertical = 2 * std::atan(0.5);
  solved.energy.estimate.emplace().deviation.assign(64, Color(0.1f * 1.5f));
  return solved;
}

std::string warning(const Solved& solved, const SolveConfig& config = {}) {
  const RayScene ray_scene(solved.scene);
  const PatchLookup lookup(solved.scene);
  ErrorsInView errors(solved.scene, ray_scene, lookup, solved.energy);
  errors.add(solved.camera, 1.0);
  return errors.warning(config);
}

void make_uncertain(Solved& solved, int patches) {
  for (int i = 0; i < patches; ++i) solved.energy.estimate->deviation[8 * i] = Color(0.39f * 1.5f);
}

TEST(ErrorsInView, AreNotWarnedOfBelowATenthOfWhatIsSeen) {
  Solved solved = floor_in_view();
  EXPECT_EQ(warning(solved), "");
  make_uncertain(solved, 5);  // of 64
  EXPECT_EQ(warning(solved), "");
}

TEST(ErrorsInView, NameNodeAndCameraAndWhatMendsThem) {
  Solved solved = floor_in_view();
  make_uncertain(solved, 8);
  EXPECT_EQ(warning(solved),
            "the light on a tenth of a surface that camera `above` sees, node `node`, may be 39% off: raise solve.rays "
            "(now 256) "
            "to about 992");
  SolveConfig config;
  config.form_factors = "hemicube";
  EXPECT_THAT(warning(solved, config), testing::EndsWith("raise solve.hemicube_resolution (now 128)"));
}

TEST(ErrorsInView, LeaveOutWhatNoCameraSees) {
  Solved solved = floor_in_view();
  make_uncertain(solved, 8);
  solved.camera.to_world.x[3][0] = 100;
  EXPECT_EQ(warning(solved), "");
}

TEST(ErrorsInView, LeaveOutEmittersAndBlackSurfaces) {
  Solved solved = floor_in_view();
  make_uncertain(solved, 8);
  for (Patch& patch : solved.scene.patches) patch.reflectance = Color(0.0f);
  EXPECT_EQ(warning(solved), "");
  for (Patch& patch : solved.scene.patches) patch.emission = patch.reflectance = Color(0.5f);
  EXPECT_EQ(warning(solved), "");
}

}  // namespace
}  // namespace patchlight
