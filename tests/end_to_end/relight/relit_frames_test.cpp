#include "tests/end_to_end/relight/relight_job.h"

namespace patchlight::test {
namespace {

TEST_F(Relight, LeavesTracedFramesAsTheyAre) {
  ASSERT_EQ(patchlight("run").code, 0);
  const std::string before = read_text(frame());
  const Outcome outcome = patchlight("relight", kOtherLights);
  EXPECT_THAT(outcome.err, HasSubstr("relit/camera.0001.exr in "));
  EXPECT_EQ(read_text(frame()), before);
  EXPECT_EQ(patchlight("status").code, 0);
  EXPECT_EQ(patchlight("status", kOtherLights).code, 1);
  Image source = read_exr_header(frame()), made = read_exr_header(relit());
  EXPECT_EQ(made.metadata["patchlight:relit_from"], source.metadata["patchlight:key"]);
  EXPECT_THAT(made.metadata["patchlight:job"], HasSubstr("wall:\n    scale: 2\n"));
  // A relit frame does not pass for a traced one.
  fs::copy_file(relit(), frame(), fs::copy_options::overwrite_existing);
  fs::copy_file(relit("camera.0001.png"), frame("camera.0001.png"), fs::copy_options::overwrite_existing);
  EXPECT_THAT(patchlight("status", kOtherLights).out, HasSubstr("stale"));
}

TEST_F(Relight, RefusesWhatNeedsARun) {
  Outcome outcome = patchlight("relight");
  EXPECT_EQ(outcome.code, 66);
  EXPECT_THAT(outcome.err, HasSubstr("nothing to relight yet"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  ASSERT_EQ(patchlight("run").code, 0);
  outcome = patchlight("relight", {"--set", "trace.layers=[]"});
  EXPECT_EQ(outcome.code, 78);
  EXPECT_THAT(outcome.err, HasSubstr("add `light_groups` to it"));
  EXPECT_EQ(patchlight("relight", {"--set", "lights.moon.scale=2"}).code, 78);
  EXPECT_EQ(patchlight("relight", {"--set", "trace.view=none"}).code, 78);
  outcome = patchlight("relight", {"--set", "solve.rays=65"});
  EXPECT_EQ(outcome.code, 65);
  EXPECT_THAT(outcome.err, HasSubstr("solve.rays 64 -> 65"));
  outcome = patchlight("relight", {"--set", "import.patch_area=0.02"});
  EXPECT_EQ(outcome.code, 65);
  EXPECT_THAT(outcome.err, HasSubstr("of another scene: import.patch_area 0.01 -> 0.02"));
  EXPECT_FALSE(fs::exists(folder_ / "out/relit"));
}

TEST_F(Relight, MakesOnlyFramesThatAreNotUpToDate) {
  ASSERT_EQ(patchlight("run", kTwoFrames).code, 0);
  Outcome outcome = patchlight("relight", concatenated(kTwoFrames, kOtherLights));
  EXPECT_THAT(outcome.err, HasSubstr("relight runs: spin.0001.exr to spin.0002.exr: missing\n"));
  EXPECT_EQ(relit_count(outcome), 2);
  const std::string first = read_text(relit("spin.0001.exr"));
  outcome = patchlight("relight", concatenated(kTwoFrames, kOtherLights));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("relight skipped: up to date\n"));
  fs::remove(relit("spin.0002.png"));
  outcome = patchlight("relight", concatenated(kTwoFrames, kOtherLights));
  EXPECT_THAT(outcome.err, HasSubstr("relight runs: spin.0002.exr: its PNG is missing\n"));
  EXPECT_THAT(outcome.err, HasSubstr("1 of 2 frames are up to date"));
  EXPECT_EQ(relit_count(outcome), 1);
  EXPECT_EQ(read_text(relit("spin.0001.exr")), first);
  EXPECT_EQ(relit_count(patchlight("relight", concatenated(concatenated(kTwoFrames, kOtherLights), {"--force"}))), 2);
  outcome = patchlight(
      "relight", concatenated(concatenated(kTwoFrames, kOtherLights), {"--set", "lights.wall.scale=3", "--explain"}));
  EXPECT_THAT(outcome.err, HasSubstr("relight runs: spin.0001.exr to spin.0002.exr: lights.wall.scale 2 -> 3\n"));
  EXPECT_EQ(relit_count(outcome), 2);
  EXPECT_EQ(run_program(folder_, "patchlight-trace", {"job.yaml", "--relight"}).code, 66) << "always makes all";
}

TEST_F(Relight, DoesNotDependOnTheLightsThatFramesWereTracedUnder) {
  ASSERT_EQ(patchlight("run").code, 0);
  ASSERT_EQ(patchlight("relight", kOtherLights).code, 0);
  const Image before = read_exr_layers(relit());
  ASSERT_EQ(patchlight("run", {"--set", "lights.wall.scale=0", "--set", "trace.exposure=3"}).code, 0);
  EXPECT_THAT(patchlight("relight", kOtherLights).err, HasSubstr("relight skipped: up to date"));
  ASSERT_EQ(patchlight("relight", concatenated(kOtherLights, {"--force"})).code, 0);
  EXPECT_EQ(read_exr_layers(relit()).pixels, before.pixels);
}

TEST_F(Relight, IsListedByStatusAndShownInTheReport) {
  const auto status = [&](const std::vector<std::string>& more = {}) {
    return patchlight("status", concatenated(kTwoFrames, more));
  };
  ASSERT_EQ(patchlight("run", kTwoFrames).code, 0);
  EXPECT_THAT(status().out, Not(HasSubstr("relight"))) << "the job has no relit frames";
  ASSERT_EQ(patchlight("relight", kTwoFrames).code, 0);
  EXPECT_THAT(status().out, HasSubstr("relight fresh    relit/spin.0001.exr\nrelight fresh    relit/spin.0002.exr\n"));
  EXPECT_THAT(status({"--set", "lights.wall.scale=2"}).out,
              HasSubstr("relight stale    relit/spin.0001.exr  lights.wall.color none -> [1, 1, 1], "
                        "lights.wall.scale none -> 2\n"));
  EXPECT_THAT(status({"--set", "trace.samples=9"}).out, HasSubstr("relit/spin.0002.exr  trace.samples 4 -> 9\n"));
  fs::remove(relit("spin.0001.exr"));
  const std::string whole = read_text(relit("spin.0002.exr"));
  folder_.write("out/relit/spin.0002.exr", whole.substr(0, whole.size() / 2));
  const Outcome outcome = status();
  EXPECT_EQ(outcome.code, 0) << "all outputs of a run are fresh";
  EXPECT_THAT(outcome.out, HasSubstr("relight missing  relit/spin.0001.exr\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("relight damaged  relit/spin.0002.exr  .*damaged EXR"));

  ASSERT_EQ(patchlight("report", kTwoFrames).code, 0);
  const std::string page = read_text(folder_ / "out/report.html");
  EXPECT_THAT(page, HasSubstr("<h3>Relit frames</h3>\n<p class=\"warning\">Stale: "
                              "spin.0001.exr: missing</p>"));
  EXPECT_THAT(page, HasSubstr("spin.0001, missing</figcaption>")) << "its PNG exists";
  EXPECT_THAT(page, HasSubstr("spin.0002, damaged</figcaption>"));
}

TEST_F(Relight, KeepsNoFrameThatLacksALayer) {
  ASSERT_EQ(patchlight("run").code, 0);
  ASSERT_EQ(patchlight("relight").code, 0);
  Image bare = read_exr_layers(relit());
  bare.layers.erase(bare.layers.begin());
  write_exr(relit(), bare);
  EXPECT_THAT(patchlight("status").out,
              HasSubstr("relight damaged  relit/camera.0001.exr  it lacks the layer `Combined_lights.ceiling`\n"));
  EXPECT_EQ(relit_count(patchlight("relight")), 1);
}

TEST_F(Relight, RelightsAllVariantsAndIsCleaned) {
  write("half", "[light_groups]", "matrix: {trace.samples: [1, 4]}\n");
  ASSERT_EQ(patchlight("run", {"--variant", "4"}).code, 0);
  const Outcome outcome = patchlight("relight", kOtherLights);
  EXPECT_EQ(outcome.code, 66) << outcome.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/4/relit/camera.0001.exr"));
  EXPECT_EQ(patchlight("relight", {"--variant", "4"}).code, 0);
  EXPECT_EQ(patchlight("clean", {"--all"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace patchlight::test
