#include <gmock/gmock.h>

#include <regex>

#include "tests/end_to_end/program.h"

namespace patchlight {
namespace {

using test::Outcome;
using test::run_program;
using test::small_job;
using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

class Rerun : public ::testing::Test {
 protected:
  void SetUp() override {
    small_job(folder_);
    const Outcome first = run({});
    ASSERT_EQ(first.code, 0) << first.err;
    ASSERT_EQ(stages(first), "import solve trace");
  }

  Outcome run(std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "job.yaml"});
    return run_program(folder_, "patchlight", more);
  }

  /// The stages that ran, in order.
  static std::string stages(const Outcome& outcome) {
    std::string names;
    static const std::regex ran("patchlight-run: (?:warning: )?(import|solve|trace) runs");
    for (std::sregex_iterator i(outcome.err.begin(), outcome.err.end(), ran), end; i != end; ++i)
      names += (names.empty() ? "" : " ") + (*i)[1].str();
    return names;
  }

  TemporaryFolder folder_;
};

TEST_F(Rerun, WritesAFrameAsExrAndPng) {
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/frames/camera.0001.exr"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/frames/camera.0001.png"));
}

TEST_F(Rerun, SkipsEverythingWhenNothingChanged) {
  const Outcome again = run({});
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(stages(again), "");
  EXPECT_THAT(again.err, HasSubstr("trace skipped: up to date"));
}

TEST_F(Rerun, TracesAloneForAnotherPictureOfTheSameLight) {
  EXPECT_EQ(stages(run({"--set", "trace.resolution=[16, 16]"})), "trace");
  EXPECT_EQ(stages(run({"--set", "lights.\"lights.ceiling\".scale=2"})), "trace");
  EXPECT_EQ(stages(run({"--set", "trace.view=ACES"})), "trace");
}

TEST_F(Rerun, SolvesAgainForMoreRays) {
  EXPECT_EQ(stages(run({"--set", "solve.rays=80"})), "solve trace");
}

TEST_F(Rerun, RunsAllForAnotherPatchArea) {
  EXPECT_EQ(stages(run({"--set", "import.patch_area=0.02"})), "import solve trace");
}

TEST_F(Rerun, DoesNotSolveAgainWhenTheSceneOnlyMovedItsCamera) {
  std::string glb = test::read_text(folder_ / "box.glb");
  const std::size_t at = glb.find("\"yfov\":0.6");
  ASSERT_NE(at, std::string::npos);
  glb[at + 9] = '7';  // keeps the length of the JSON
  folder_.write("box.glb", glb);
  EXPECT_EQ(stages(run({})), "import trace");
}

TEST_F(Rerun, SolvesAgainForAShaderThatChangesPatches) {
  const auto with = [&](const std::string& expression) {
    return stages(run({"--set", "shaders.\"*\".reflectance=" + expression}));
  };
  EXPECT_EQ(with("0.3 + x*0"), "import solve trace");
  EXPECT_EQ(with("0.3 + x*0"), "");
  EXPECT_EQ(with("0.3 + y*0"), "import trace");
  EXPECT_EQ(stages(run({})), "import solve trace");
}

TEST_F(Rerun, DoesNothingForATouchedFileOrAComment) {
  folder_.write("box.glb", test::read_text(folder_ / "box.glb"));
  folder_.write("job.yaml", "# a comment\n" + test::read_text(folder_ / "job.yaml"));
  EXPECT_EQ(stages(run({})), "");
}

TEST_F(Rerun, RebuildsADamagedFileWithAWarning) {
  for (const auto& [file, ran] : {std::pair("out/patches.h5", "import"), std::pair("out/energy.h5", "solve"),
                                  std::pair("out/frames/camera.0001.exr", "trace")}) {
    const std::string whole = test::read_text(folder_ / file);
    folder_.write(file, whole.substr(0, whole.size() / 2));
    const Outcome outcome = run({});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(stages(outcome), ran) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: " + std::string(ran) + " runs again"));
  }
}

TEST_F(Rerun, ForceRunsEverything) {
  EXPECT_EQ(stages(run({"--force"})), "import solve trace");
}

TEST_F(Rerun, StagesAlwaysRunByThemselves) {
  const Outcome outcome = run_program(folder_, "patchlight-trace", {"job.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("camera.0001.exr"));
}

TEST_F(Rerun, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const char* threads : {"1", "2", "3"}) {
    const std::string out = std::string("out") + threads;
    ASSERT_EQ(run({"--output", out, "--threads", threads}).code, 0);
    for (const char* file : {"patches.h5", "energy.h5", "frames/camera.0001.exr"}) {
      const Outcome diff = run_program(folder_, "patchlight", {"diff", std::string("out/") + file, out + "/" + file});
      EXPECT_EQ(diff.code, 0) << file << diff.out << diff.err;
    }
  }
}

TEST_F(Rerun, DiffTellsWhatDiffersAndByHowMuch) {
  ASSERT_EQ(run({"--output", "other", "--set", "solve.rays=80"}).code, 0);
  const auto diff = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"diff", "out/energy.h5", "other/energy.h5"});
    return run_program(folder_, "patchlight", more);
  };
  EXPECT_EQ(diff({}).code, 1);
  EXPECT_THAT(diff({}).out, HasSubstr("/groups/lights.ceiling/direct"));
  EXPECT_EQ(diff({"--tolerance", "0.5"}).code, 0);
  EXPECT_EQ(diff({"--tolerance", "0.5", "--max", "1e-6"}).code, 1);
  EXPECT_EQ(run_program(folder_, "patchlight", {"diff", "out/energy.h5", "out/patches.h5"}).code, 65);
}

TEST_F(Rerun, InfoShowsWhatIsInEveryKindOfFile) {
  const auto info = [&](const std::string& file) { return run_program(folder_, "patchlight", {"info", file}).out; };
  EXPECT_THAT(info("box.glb"), HasSubstr("lights.ceiling"));
  EXPECT_THAT(info("out/patches.h5"), HasSubstr("lights.ceiling"));
  EXPECT_THAT(info("out/energy.h5"), HasSubstr("progressive over rays"));
  EXPECT_THAT(info("out/frames/camera.0001.exr"), HasSubstr("32 x 32"));
}

}  // namespace
}  // namespace patchlight
