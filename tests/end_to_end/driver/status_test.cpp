#include <gmock/gmock.h>

#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

class Status : public ProgramTest {
 protected:
  void SetUp() override {
    small_job(folder_);
    ASSERT_EQ(run({"run"}).code, 0);
  }

  Outcome run(std::vector<std::string> words) {
    words.insert(words.begin() + 1, "job.yaml");
    return run_program(folder_, "patchlight", words);
  }

  /// Output of `status` for the job with one override. Expects exit code 1 if any output is not fresh.
  std::string status(const std::string& set = "") {
    const Outcome outcome =
        run(set.empty() ? std::vector<std::string>{"status"} : std::vector<std::string>{"status", "--set", set});
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.code, outcome.out.find("stale") == std::string::npos &&
                                    outcome.out.find("missing") == std::string::npos &&
                                    outcome.out.find("damaged") == std::string::npos
                                ? 0
                                : 1);
    return outcome.out;
  }
};

constexpr const char* kAllFresh =
    "import  fresh    patches.h5\nsolve   fresh    energy.h5\ntrace   fresh    frames/camera.0001.exr\n";

TEST_F(Status, ReportsThatAllIsFresh) {
  EXPECT_EQ(status(), kAllFresh);
}

TEST_F(Status, IgnoresCommentsSpellingAndUnrelatedKeys) {
  std::string job = "# a comment\n" + read_text(folder_ / "job.yaml");
  job.replace(job.find("box.glb"), 7, "././box.glb");
  folder_.write("job.yaml", job + "bench: {repeats: 3}\n");
  EXPECT_EQ(status(), kAllFresh);
  EXPECT_EQ(status("solve.hemicube_resolution=64"), kAllFresh) << "not used with rays";
  EXPECT_EQ(status("solve.max_shots=7"), kAllFresh) << "not used by the matrix method";
  EXPECT_EQ(status("import.max_patches=100000"), kAllFresh);
  EXPECT_EQ(status("lights.\"lights.ceiling\".scale=1"), kAllFresh) << "the default";
}

TEST_F(Status, NamesTheSettingThatChangedWithItsOldAndItsNewValue) {
  std::string text = status("trace.samples=9");
  EXPECT_THAT(text, HasSubstr("solve   fresh"));
  EXPECT_THAT(text, HasSubstr("trace   stale    frames/camera.0001.exr  trace.samples 4 -> 9\n"));
  text = status("trace.resolution=[16, 16]");
  EXPECT_THAT(text, HasSubstr("trace   stale    frames/camera.0001.exr  trace.resolution [32, 32] -> [16, 16]\n"));
  text = status("lights.\"lights.ceiling\".scale=2");
  EXPECT_THAT(text, HasSubstr("solve   fresh"));
  EXPECT_THAT(text, HasSubstr("exr  lights.\"lights.ceiling\".color none -> [1, 1, 1], "
                              "lights.\"lights.ceiling\".scale none -> 2\n"));
  text = status("solve.rays=80");
  EXPECT_THAT(text, HasSubstr("solve   stale    energy.h5  solve.rays 64 -> 80\n"));
  EXPECT_THAT(text, HasSubstr("trace   stale    frames/camera.0001.exr  solve.rays 64 -> 80\n"));
  text = status("solve.tolerance=0.01");
  EXPECT_THAT(text, HasSubstr("energy.h5  solve.tolerance 0.001 -> 0.01\n"));
  text = status("materials.red.reflectance=[0.5, 0.1, 0.1]");
  EXPECT_THAT(text, HasSubstr("import  stale    patches.h5  materials.red.reflectance none -> [0.5, 0.1, 0.1]\n"));
  EXPECT_THAT(text, HasSubstr("solve   unknown"));
}

TEST_F(Status, NamesTheChangedSceneAndThenItsCamera) {
  std::string glb = read_text(folder_ / "box.glb");
  glb[glb.find("\"yfov\":0.6") + 9] = '7';
  folder_.write("box.glb", glb);
  EXPECT_THAT(status(), ContainsRegex("import  stale    patches.h5  box.glb [0-9a-f]{8} -> [0-9a-f]{8}\n"));
  ASSERT_EQ(run_program(folder_, "patchlight-import", {"job.yaml"}).code, 0);
  EXPECT_THAT(status(), HasSubstr("solve   fresh"));
  EXPECT_THAT(status(), ContainsRegex("trace   stale .*exr  the camera [0-9a-f]{8} -> [0-9a-f]{8}\n"));
  std::filesystem::remove(folder_ / "box.glb");
  EXPECT_THAT(status(), ContainsRegex("import  stale    patches.h5  .*box.glb is gone"));
}

TEST_F(Status, ReportsMissingAndDamagedFiles) {
  const auto damage = [&](const std::string& file) {
    const std::string whole = read_text(folder_ / file);
    folder_.write(file, whole.substr(0, whole.size() / 2));
  };
  damage("out/frames/camera.0001.png");
  EXPECT_THAT(status(), HasSubstr("trace   damaged  frames/camera.0001.exr  its PNG is damaged\n"));
  std::filesystem::remove(folder_ / "out/frames/camera.0001.exr");
  EXPECT_THAT(status(), HasSubstr("trace   missing  frames/camera.0001.exr\n"));
  damage("out/transport.h5");
  EXPECT_THAT(status(), ContainsRegex("solve   damaged  energy.h5  .*transport.h5"));
  damage("out/energy.h5");
  EXPECT_THAT(status(), HasSubstr("solve   damaged  energy.h5"));
  damage("out/patches.h5");
  EXPECT_THAT(status(), HasSubstr("import  damaged  patches.h5"));
  std::filesystem::remove(folder_ / "out/patches.h5");
  EXPECT_THAT(status(), HasSubstr("import  missing  patches.h5\n"));
}

TEST_F(Status, ReportsAFrameWithoutALayerAsDamaged) {
  const std::vector<std::string> layers{"--set", "trace.layers=[albedo, depth, patch, light_groups]"};
  const auto with_layers = [&](const std::string& command) { return run({command, layers[0], layers[1]}); };
  ASSERT_EQ(with_layers("run").code, 0);
  const auto frame = folder_ / "out/frames/camera.0001.exr";
  const Image whole = read_exr_layers(frame);
  for (const ImageLayer& missing : whole.layers) {
    Image bare = whole;
    std::erase_if(bare.layers, [&](const ImageLayer& layer) { return layer.name == missing.name; });
    write_exr(frame, bare);
    const std::string reason = "it lacks the layer `" + missing.name + "`\n";
    EXPECT_THAT(with_layers("status").out, HasSubstr("trace   damaged  frames/camera.0001.exr  " + reason));
    const Outcome outcome = run({"run", "--explain", "--set", "cache=0", layers[0], layers[1]});
    EXPECT_THAT(outcome.err, HasSubstr("warning: trace runs again: camera.0001.exr: " + reason));
    EXPECT_THAT(outcome.err, HasSubstr("camera.0001.exr in ")) << "the stage does not skip it";
    EXPECT_THAT(with_layers("status").out, HasSubstr("trace   fresh"));
  }
}

TEST_F(Status, ChangesNothing) {
  const auto before = std::filesystem::last_write_time(folder_ / "out");
  const Outcome outcome = run({"status", "--output", "other"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other"));
  status("solve.rays=80");
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "out"), before);
}

TEST_F(Status, RefusesTheSameJobsAsARun) {
  EXPECT_EQ(run({"status", "--set", "trace.cameras=[nobody]"}).code, 78);
  EXPECT_EQ(run_program(folder_, "patchlight", {"status", "none.yaml"}).code, 66);
}

TEST_F(Status, IsReportedByRun) {
  Outcome outcome = run({"run", "--explain"});
  EXPECT_THAT(outcome.err, ContainsRegex("import skipped: up to date: all that it depends on still has the key"));
  EXPECT_THAT(outcome.err, ContainsRegex("trace skipped: up to date: all that it depends on still has the key"));
  outcome = run({"run", "--explain", "--set", "solve.rays=80", "--set", "solve.seed=2"});
  EXPECT_THAT(outcome.err, HasSubstr("solve runs: solve.rays 64 -> 80; solve.seed 1 -> 2\n"));
  EXPECT_THAT(outcome.err, HasSubstr("trace runs: camera.0001.exr: solve.rays 64 -> 80, solve.seed 1 -> 2\n"));
  EXPECT_THAT(run({"run"}).err, HasSubstr("solve restored, made before: solve.rays 80 -> 64, and 1 more"));
  outcome = run({"run", "--set", "solve.rays=96"});
  EXPECT_THAT(outcome.err, HasSubstr("solve runs: solve.rays 64 -> 96\n"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("still has the key")));
}

}  // namespace
}  // namespace patchlight::test
