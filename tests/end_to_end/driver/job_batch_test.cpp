#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <tuple>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

class JobBatch : public ProgramTest {
 protected:
  void SetUp() override { small_job(folder_); }

  Outcome run(const std::vector<std::string>& words) { return run_program(folder_, "patchlight", words); }
};

TEST_F(JobBatch, ContinuesAfterAFailedJobAndPrintsASummary) {
  folder_.write("bad.yaml", "scene: none.glb\noutput: bad\n");
  folder_.write("broken.yaml", "scene: [\n");
  folder_.write("other.yaml", "include: job.yaml\noutput: other\n");
  const Outcome outcome = run({"run", "job.yaml", "bad.yaml", "broken.yaml", "other.yaml"});
  EXPECT_EQ(outcome.code, 66) << outcome.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/frames/camera.0001.exr"));
  EXPECT_TRUE(fs::exists(folder_ / "other/frames/camera.0001.exr"));
  EXPECT_THAT(outcome.err, ContainsRegex("done      job.yaml: import [0-9.]+ s, solve [0-9.]+ s, trace [0-9.]+ s\n"));
  EXPECT_THAT(outcome.err, HasSubstr("failed 66 bad.yaml: import failed\n"));
  EXPECT_THAT(outcome.err, HasSubstr("failed 78 broken.yaml: nothing ran\n"));
  EXPECT_THAT(outcome.err, ContainsRegex("2 of 4 done, 2 failed, in [0-9.]+ s\n"));
  EXPECT_EQ(run({"run", "job.yaml", "other.yaml"}).code, 0);
  EXPECT_EQ(run({"run", "job.yaml", "other.yaml", "--output", "one"}).code, 64);
}

TEST_F(JobBatch, MakesEveryVariantOfAMatrixFromOneSolve) {
  folder_.write("job.yaml",
                read_text(folder_ / "job.yaml") +
                    "matrix:\n"
                    "  trace.samples: [1, 4]\n"
                    "  mood: {day: {}, night: {lights.\"lights.ceiling\".scale: 0.1, trace.exposure: 1}}\n");
  Outcome outcome = run({"run", "job.yaml"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* variant : {"1,day", "1,night", "4,day", "4,night"}) {
    EXPECT_TRUE(fs::exists(folder_ / (std::string("out/") + variant + "/frames/camera.0001.png"))) << variant;
    EXPECT_EQ(fs::hard_link_count(folder_ / (std::string("out/") + variant + "/energy.h5")), 5)
        << "one solve for all variants";
  }
  EXPECT_THAT(outcome.err,
              ContainsRegex("done      job.yaml 1,day: import [0-9.]+ s, solve [0-9.]+ s, trace [0-9.]+ s\n"));
  EXPECT_THAT(outcome.err,
              ContainsRegex("done      job.yaml 4,night: import restored, solve restored, trace [0-9.]+ s\n"));
  EXPECT_NE(read_text(folder_ / "out/1,day/frames/camera.0001.exr"),
            read_text(folder_ / "out/1,night/frames/camera.0001.exr"));

  outcome = run({"status", "job.yaml"});
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("job.yaml 4,night\nimport  fresh"));
  outcome = run({"run", "job.yaml", "--variant", "*,night", "--set", "trace.quality=patches"});
  EXPECT_THAT(outcome.err, HasSubstr("2 of 2 done, 0 failed"));
  EXPECT_EQ(run({"run", "job.yaml", "--variant", "noon"}).code, 78);
  EXPECT_EQ(run({"clean", "job.yaml", "--all"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

/// Matrix of cameras x moods x patch areas.
TEST_F(JobBatch, SolvesOnceForEachPatchAreaOfAMatrix) {
  folder_.write("job.yaml", read_text(folder_ / "job.yaml") +
                                "cameras:\n  near: {look_from: [0, 0.28, 0.9], look_at: [0, 0.28, 0]}\n"
                                "matrix:\n"
                                "  trace.cameras: [camera, near]\n"
                                "  mood: {day: {}, night: {lights.\"lights.ceiling\".scale: 0.1}}\n"
                                "  import.patch_area: [0.02, 0.01]\n");
  Outcome outcome = run({"run", "job.yaml", "--log-json", "log"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("8 of 8 done, 0 failed"));
  std::map<std::string, int> states;
  std::istringstream lines(read_text(folder_ / "log"));
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json entry = nlohmann::json::parse(line);
    if (entry["level"] == "result")
      ++states[entry["target"].get<std::string>() + " " + entry["message"].get<std::string>()];
  }
  EXPECT_EQ(
      states,
      (std::map<std::string, int>{
          {"import done", 2}, {"import restored", 6}, {"solve done", 2}, {"solve restored", 6}, {"trace done", 8}}));
  EXPECT_TRUE(fs::exists(folder_ / "out/near,night,0.01/frames/near.0001.exr"));
}

TEST_F(JobBatch, RefusesAMatrixOfUnknownOrBadSettings) {
  const std::string job = read_text(folder_ / "job.yaml");
  for (const auto& [matrix, message] : {std::pair("{solve.raise: [1, 2]}", "unknown key `solve.raise`"),
                                        {"{output: [a, b]}", "`output` cannot vary"},
                                        {"{mood: {day: {solve.rays: -1}}}", "bad value of `solve.rays`"},
                                        {"{mood: 3}", "bad value of `matrix.mood`"},
                                        {"{solve.rays: []}", "`matrix.solve.rays` is empty"}}) {
    folder_.write("job.yaml", job + "matrix: " + matrix + "\n");
    const Outcome outcome = run({"run", "job.yaml"});
    EXPECT_EQ(outcome.code, 78) << matrix;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_THAT(outcome.err, HasSubstr("line 6"));
  }
}

TEST_F(JobBatch, LogsEveryStageOfEveryJob) {
  folder_.write("other.yaml", "include: job.yaml\nsolve: {rays: 80}\n");
  ASSERT_EQ(run({"run", "job.yaml", "other.yaml", "--log-json", "log"}).code, 0);
  ASSERT_EQ(run({"run", "job.yaml", "--log-json", "log"}).code, 0);
  std::istringstream lines(read_text(folder_ / "log"));
  std::string results;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json entry = nlohmann::json::parse(line);
    EXPECT_TRUE(entry.contains("stage") && entry.contains("seconds")) << line;
    if (entry["level"] != "result") continue;
    results += entry["job"].get<std::string>() + " " + entry["target"].get<std::string>() + " " +
               entry["message"].get<std::string>() + "\n";
    if (entry["message"] == "done") {
      EXPECT_GT(entry["wall_seconds"], 0);
      EXPECT_GT(entry["peak_bytes"], 1 << 20);
    }
  }
  EXPECT_EQ(results,
            "job.yaml import done\njob.yaml solve done\njob.yaml trace done\n"
            "other.yaml import fresh\nother.yaml solve done\nother.yaml trace done\n"
            "job.yaml import fresh\njob.yaml solve restored\njob.yaml trace restored\n");
}

TEST_F(JobBatch, ShowsAProgressLineOnlyInATerminal) {
  ASSERT_EQ(run({"run", "job.yaml"}).code, 0);
  const auto by = [&](const std::string& command) {
    const std::string line = "cd " + quoted(folder_.path().string()) + " && " + command;
    return std::system(line.c_str());
  };
  for (const auto& [stage, setting, part] :
       {std::tuple("solve", "solve.rays=15000", "rows of form factors"),
        {"trace", "trace.resolution=[800,800] --set trace.samples=64", "camera"}}) {
    const std::string slow = (fs::path(PATCHLIGHT_PROGRAMS) / "patchlight-").string() + stage + " --set " + setting +
                             " --threads 1 job.yaml";
    EXPECT_EQ(by("script -qec '" + slow + "' /dev/null >terminal.txt </dev/null"), 0);
    const std::string terminal = read_text(folder_ / "terminal.txt");
    EXPECT_THAT(terminal, ContainsRegex(std::string("\r.\\[Kpatchlight-") + stage + ":  *[0-9]+%  " + part +
                                        "  [0-9.]+ million rays/s"));
    EXPECT_THAT(terminal, ContainsRegex("[0-9] s left"));
    const std::regex percent(std::string(stage) + ": +([0-9]+)%  ");
    std::vector<int> percents;
    for (std::sregex_iterator at(terminal.begin(), terminal.end(), percent), end; at != end; ++at)
      percents.push_back(std::stoi((*at)[1]));
    EXPECT_GT(percents.size(), 2u);
    EXPECT_TRUE(std::is_sorted(percents.begin(), percents.end())) << "of the whole stage";
    EXPECT_EQ(by(slow + " 2>plain.txt"), 0);
    EXPECT_THAT(read_text(folder_ / "plain.txt"), Not(HasSubstr("\r")));
  }
}

TEST_F(JobBatch, StopsAtASignalAndContinuesFromThere) {
  folder_.write("long.yaml", "include: job.yaml\noutput: long\nsolve: {rays: 1000000}\n");
  folder_.write("after.yaml", "include: job.yaml\noutput: after\n");
  const Outcome outcome = run_program(folder_, "patchlight", {"run", "job.yaml", "long.yaml", "after.yaml"},
                                      "timeout --foreground --preserve-status -s INT 4");
  EXPECT_EQ(outcome.code, 75) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("failed 75 long.yaml"));
  EXPECT_THAT(outcome.err, HasSubstr("done      job.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "after"));
  const Outcome again = run({"run", "job.yaml", "long.yaml", "after.yaml", "--set", "solve.rays=64"});
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("done      job.yaml: import fresh, solve fresh, trace fresh\n"));
  EXPECT_THAT(again.err, ContainsRegex("done      long.yaml: import fresh, solve [0-9.]+ s"));
}

}  // namespace
}  // namespace patchlight::test
