#include <gmock/gmock.h>

#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::vector<std::string> kSmall{"--set", "import.patch_area=0.01",    "--set", "solve.rays=64",
                                      "--set", "trace.resolution=[32, 32]", "--set", "trace.samples=4"};

/// A scene in place of a job.
class SceneJob : public ProgramTest {
 protected:
  void SetUp() override {
    fs::create_directory(folder_ / "scenes");
    fs::copy_file(std::string(PATCHLIGHT_SOURCE) + "/configs/cornell_box.glb", folder_ / "scenes/box.GLB");
  }

  Outcome patchlight(const std::string& command, const std::string& job = "scenes/box.GLB",
                     const std::vector<std::string>& settings = kSmall) {
    std::vector<std::string> words{command, job};
    words.insert(words.end(), settings.begin(), settings.end());
    return run_program(folder_, "patchlight", words);
  }
};

TEST_F(SceneJob, RunsWithItsOutputBesideTheScene) {
  const Outcome first = patchlight("run");
  ASSERT_EQ(first.code, 0) << first.err;
  for (const char* file : {"patches.h5", "energy.h5", "frames/camera.0001.exr", "frames/camera.0001.png"})
    EXPECT_TRUE(fs::exists(folder_ / (std::string("scenes/box.patchlight/") + file))) << file;
  EXPECT_THAT(patchlight("run").err, HasSubstr("trace skipped: up to date"));
  EXPECT_EQ(patchlight("status").code, 0);
  EXPECT_EQ(patchlight("clean", "scenes/box.GLB", {"--all"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "scenes/box.patchlight"));
}

TEST_F(SceneJob, IsTakenByEveryProgram) {
  for (const char* stage : {"patchlight-import", "patchlight-solve", "patchlight-trace"}) {
    std::vector<std::string> words = kSmall;
    words.push_back("scenes/box.GLB");
    const Outcome outcome = run_program(folder_, stage, words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }
  EXPECT_EQ(patchlight("status").code, 0);
  const std::vector<std::string> layers{"--set", "trace.layers=[light_groups]"};
  std::vector<std::string> settings = kSmall;
  settings.insert(settings.end(), layers.begin(), layers.end());
  EXPECT_EQ(patchlight("run", "scenes/box.GLB", settings).code, 0);
  EXPECT_EQ(patchlight("relight", "scenes/box.GLB", settings).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "scenes/box.patchlight/relit/camera.0001.exr"));
}

TEST_F(SceneJob, IsRefusedWhereItIsNoScene) {
  const Outcome missing = patchlight("run", "none.glb");
  EXPECT_EQ(missing.code, 66);
  EXPECT_FALSE(fs::exists(folder_ / "none.patchlight"));
  folder_.write("room.blend", "BLENDER");
  ::setenv("BLENDER", "/none/blender", 1);
  const Outcome blend = patchlight("run", "room.blend");
  EXPECT_EQ(blend.code, 69);
  EXPECT_THAT(blend.err, HasSubstr("set it to Blender's program"));
  for (const std::string program : {"patchlight-import", "patchlight-solve"})
    EXPECT_EQ(run_program(folder_, program, {"room.blend"}).code, 69);
  EXPECT_EQ(patchlight("from-blend", "room.blend", {}).code, 69);
  EXPECT_EQ(patchlight("from-blend", "none.glb", {}).code, 64);
  EXPECT_FALSE(fs::exists(folder_ / "room.patchlight/patches.h5"));
  ::unsetenv("BLENDER");
}

TEST_F(SceneJob, IsPrintedAsAJobThatMakesTheSameFrames) {
  const Outcome printed = patchlight("init", "scenes/box.GLB", {});
  ASSERT_EQ(printed.code, 0) << printed.err;
  EXPECT_EQ(printed.err, "");
  EXPECT_FALSE(fs::exists(folder_ / "scenes/box.patchlight"));
  folder_.write("job.yaml", printed.out);
  ASSERT_EQ(patchlight("run").code, 0);
  const Outcome run = patchlight(
      "run", "job.yaml",
      {kSmall[0], kSmall[1], kSmall[2], kSmall[3], kSmall[4], kSmall[5], kSmall[6], kSmall[7], "--output", "out"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto pixels = [&](const std::string& folder) {
    return read_exr(folder_ / (folder + "/frames/camera.0001.exr")).pixels;
  };
  EXPECT_EQ(pixels("out"), pixels("scenes/box.patchlight"));
  EXPECT_THAT(patchlight("run", "job.yaml").err, HasSubstr("trace skipped: up to date"))
      << "its output is the scene's own";
}

TEST_F(SceneJob, IsPrintedWithMaterialsAsTheyAre) {
  std::string job = patchlight("init", "scenes/box.GLB", {}).out;
  for (std::size_t at = 0; (at = job.find("\n  # ", at)) != std::string::npos;) job.erase(at + 3, 2);
  folder_.write("job.yaml", job);
  std::vector<std::string> settings = kSmall;
  settings.insert(settings.end(), {"--output", "out"});
  ASSERT_EQ(patchlight("run").code, 0);
  const Outcome run = patchlight("run", "job.yaml", settings);
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run_program(folder_, "patchlight",
                        {"diff", "out/frames/camera.0001.exr", "scenes/box.patchlight/frames/camera.0001.exr"})
                .code,
            0);
}

TEST_F(SceneJob, IsPrintedOfASceneAlone) {
  small_job(folder_);
  EXPECT_EQ(patchlight("init", "job.yaml", {}).code, 64);
  EXPECT_EQ(patchlight("init", "none.glb", {}).code, 66);
  EXPECT_EQ(patchlight("init", "scenes/box.GLB", {"--set", "solve.rays=1"}).code, 64);
}

}  // namespace
}  // namespace patchlight::test
