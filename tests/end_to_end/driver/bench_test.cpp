#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

using nlohmann::json;

class Bench : public ProgramTest {
 protected:
  Outcome bench(const std::string& section, const std::string& environment = "") {
    small_job(folder_, "bench:\n" + section);
    return run_program(folder_, "patchlight", {"bench", "job.yaml"}, environment);
  }
  json report() const { return json::parse(read_text(folder_ / "out/bench/bench.json")); }
  bool made(const std::string& file) const {
    std::error_code fault;
    return std::filesystem::file_size(folder_ / ("out/bench/" + file), fault) > 0 && !fault;
  }
};

TEST_F(Bench, WritesTablesPlotAndComparison) {
  const Outcome outcome = bench(
      "  sweep:\n    - {import.patch_area: [0.04, 0.01], solve.rays: [16, 64]}\n    - {trace.samples: [1, 4]}\n"
      "  reference_settings: {solve.rays: 1024, trace.samples: 4}\n");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("6/6 samples 4"));
  EXPECT_TRUE(made("error_against_seconds.png"));
  EXPECT_TRUE(made("comparison.png"));

  std::istringstream csv(read_text(folder_ / "out/bench/bench.csv"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 7u);
  EXPECT_THAT(lines[0], HasSubstr("variant,grid,import.patch_area,solve.rays,trace.samples,exit_code"));
  EXPECT_THAT(lines[2], HasSubstr("\"patch_area=0.04,rays=64\",0,0.04,64,,0,"));

  const json rows = report()["variants"];
  ASSERT_EQ(rows.size(), 6u);
  for (const json& row : rows) {
    EXPECT_GT(row["stages"]["solve"]["cpu_seconds"], 0);
    EXPECT_GT(row["stages"]["trace"]["peak_bytes"], 1 << 20);
    EXPECT_GT(row["error"]["block"], 0);
    bool dominated = false;
    for (const json& other : rows) {
      const std::pair<double, double> theirs{other["cpu_seconds"], other["error"]["block"]};
      const std::pair<double, double> ours{row["cpu_seconds"], row["error"]["block"]};
      dominated |= theirs.first <= ours.first && theirs.second <= ours.second && theirs != ours;
    }
    EXPECT_EQ(row["pareto"], !dominated) << row;
  }
  EXPECT_EQ(rows[1]["settings"], (json{{"import.patch_area", 0.04}, {"solve.rays", 64}}));
  // Stages that variants share are run and measured once.
  EXPECT_EQ(rows[0]["stages"]["import"], rows[1]["stages"]["import"]);
  EXPECT_EQ(rows[4]["stages"]["solve"], rows[5]["stages"]["solve"]);
  // The reference has the patches of the job itself, 0.01 m2.
  EXPECT_TRUE(rows[0]["error"]["radiosity"].is_null());
  EXPECT_GT(rows[2]["error"]["radiosity"], rows[3]["error"]["radiosity"]);
}

TEST_F(Bench, MeasuresNoErrorAgainstTheSameImage) {
  small_job(folder_);
  ASSERT_EQ(run_program(folder_, "patchlight", {"run", "job.yaml"}).code, 0);
  const Outcome outcome = bench("  sweep: {solve.rays: 64}\n  reference: out/frames/camera.0001.exr\n  repeats: 2\n");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(report()["variants"][0]["error"]["relmse"], 0);
  EXPECT_TRUE(made("error_against_seconds.png"));
  // The bench leaves the job's own output alone.
  EXPECT_THAT(run_program(folder_, "patchlight", {"run", "job.yaml"}).err, HasSubstr("trace skipped"));
}

TEST_F(Bench, RefusesAReferenceOfAnotherShape) {
  std::filesystem::copy_file(std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/mirror_room/frame.direct.exr",
                             folder_ / "a.exr");
  const Outcome outcome = bench("  sweep: {trace.resolution: [[31, 17]]}\n  reference: a.exr\n");
  EXPECT_EQ(outcome.code, 78) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("trace.resolution"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(Bench, ComparesWithAClosedForm) {
  const Outcome outcome = bench(
      "  sweep: {solve.rays: [4]}\n  reference: {radiance: [0, 0, 0]}\nmaterials: {light: {emission: [0, 0, 0]}}\n");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(report()["variants"][0]["error"]["block"], 0);
}

TEST_F(Bench, FindsTheClosedFormOfAFurnace) {
  const std::string scene = std::string(PATCHLIGHT_SCENES) + "/blender/furnace_r050.glb";
  if (!std::filesystem::exists(scene)) GTEST_SKIP() << "no scene at " << scene;
  folder_.write("furnace.yaml", "scene: " + scene + "\noutput: out\ntrace: {resolution: [32, 32]}\n" +
                                    "bench: {sweep: [{solve.method: [progressive], solve.rays: [16, 256]}], reference: "
                                    "{radiance: [2, 1, 0.5]}}\n");
  const Outcome outcome = run_program(folder_, "patchlight", {"bench", "furnace.yaml"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json rows = report()["variants"];
  EXPECT_LT(rows[1]["error"]["block"], 0.02);
  EXPECT_LT(rows[1]["error"]["block"], rows[0]["error"]["block"]);
}

TEST_F(Bench, ContinuesAfterAVariantThatFails) {
  const Outcome outcome = bench("  sweep: {trace.view: [Sepia, sRGB]}\n  reference: {radiance: [1, 1, 1]}\n");
  EXPECT_EQ(outcome.code, 78) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("1/2 view Sepia: trace failed (exit code 78)"));
  const json rows = report()["variants"];
  EXPECT_EQ(rows[0]["exit_code"], 78);
  EXPECT_EQ(rows[0]["fault"], "trace failed");
  EXPECT_EQ(rows[1]["exit_code"], 0);
  EXPECT_TRUE(made("comparison.png"));
}

TEST_F(Bench, RefusesBadInputBeforeAnyRun) {
  EXPECT_THAT(bench("  repeats: 1\n").err, HasSubstr("nothing to sweep"));
  EXPECT_EQ(bench("  sweep: {solve.ray: [1]}\n").code, 78);
  EXPECT_EQ(bench("  sweep: {solve.rays: [1]}\n  reference: none.exr\n").code, 66);
  const Outcome outcome = bench("  sweep: {solve.rays: [1]}\n", "PATH=/none");
  EXPECT_EQ(outcome.code, 69);
  EXPECT_THAT(outcome.err, HasSubstr("gnuplot-nox"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(Bench, KeepsItsTablesWhenThePlotFails) {
  std::filesystem::create_directory(folder_ / "bin");
  std::filesystem::permissions(folder_.write("bin/gnuplot", "#!/bin/sh\nexit 1\n"), std::filesystem::perms(0755));
  const Outcome outcome = bench("  sweep: {solve.rays: [1]}\n  reference: {radiance: [1, 1, 1]}\n", "PATH=bin:$PATH");
  EXPECT_EQ(outcome.code, 69) << outcome.err;
  EXPECT_EQ(report()["variants"][0]["exit_code"], 0);
}

TEST_F(Bench, StopsWhenItIsInterrupted) {
  const Outcome outcome = bench("  sweep: {solve.rays: [2000000]}\n  reference: {radiance: [1, 1, 1]}\n",
                                "timeout --preserve-status -s TERM 3");
  EXPECT_EQ(outcome.code, 75) << outcome.err;
}

}  // namespace
}  // namespace patchlight::test
