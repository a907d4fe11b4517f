#include <gtest/gtest.h>

#include "pipeline/image/image_error.h"
#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kScenes = PATCHLIGHT_SCENES;
const std::string kJobs = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/report/";

/// The scenes of "Implementation of Radiosity" (Volokh).
class Report : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kScenes + "/seed/box.glb")) GTEST_SKIP() << "no scenes of the report at " << kScenes;
  }
  Image run(const std::string& job, const std::string& scene, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"run",      kJobs + job + ".yaml",
                                       "--output", folder_.path().string(),
                                       "--set",    "scene=" + kScenes + "/seed/" + scene + ".glb"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(folder_, "patchlight", arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return read_exr(folder_ / "frames/Camera.0001.exr");
  }
  TemporaryFolder folder_;
};

TEST_F(Report, BoxMatchesThePathTracerByRaysAndByHemicubes) {
  const Image reference = read_exr(kScenes + "/reference/seed.box.exr");
  EXPECT_LT(image_error(run("box", "box"), reference).block, 0.012);
  const Image by_hemicubes =
      run("box", "box",
          {"--set", "solve.form_factors=hemicube", "--set", "import.patch_area=0.02", "--set", "solve.tolerance=0.01"});
  EXPECT_LT(image_error(by_hemicubes, reference).block, 0.012);
}

TEST_P(Report, SceneRunsAndIsLit) {
  const Image image = run(GetParam(), std::string(GetParam()) == "box_shaders" ? "box" : GetParam());
  Vec3d mean(0.0);
  for (const Color& c : image.pixels) mean += Vec3d(c) / double(image.pixels.size());
  EXPECT_GT(mean.x, 0.05);
}

INSTANTIATE_TEST_SUITE_P(All, Report, ::testing::Values("simple", "sphere", "specular", "banner", "box_shaders"),
                         [](const auto& scene) { return std::string(scene.param); });

}  // namespace
}  // namespace patchlight::test
