#include <gmock/gmock.h>

#include <chrono>
#include <map>
#include <random>
#include <thread>

#include "tests/end_to_end/background_program.h"

namespace patchlight::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kFiles[] = {"patches.h5", "energy.h5", "transport.h5", "frames/camera.0001.exr"};

class Kill : public ProgramTest {
 protected:
  void SetUp() override { small_job(folder_); }

  /// Starts `patchlight run` with the output folder `output`.
  pid_t start(const std::string& output, const std::string& set = "solve.rays=1000") {
    return start_program("patchlight",
                         {"run", (folder_ / "job.yaml").string(), "--output=" + (folder_ / output).string(),
                          "--set=import.patch_area=0.001", "--set=" + set},
                         folder_ / (output + ".log"));
  }

  void expect_same_bits(const std::string& output) {
    for (const char* file : kFiles) {
      const Outcome diff =
          run_program(folder_, "patchlight", {"diff", std::string("whole/") + file, output + "/" + file});
      EXPECT_EQ(diff.code, 0) << output << diff.out << diff.err;
    }
    EXPECT_EQ(read_text(folder_ / (output + "/frames/camera.0001.png")),
              read_text(folder_ / "whole/frames/camera.0001.png"));
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / output))
      EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }

  /// Runs the job into the folder `whole` without a disturbance. Returns the seconds it takes.
  double run_whole() {
    const auto begin = Clock::now();
    EXPECT_EQ(wait_for(start("whole")), 0);
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }
};

TEST_F(Kill, AtAnyMomentLeavesAFolderThatARerunCompletes) {
  const double whole = run_whole();
  std::mt19937 random(1);
  int killed = 0;
  for (int k = 0; k < 20; ++k) {
    const std::string output = "killed" + std::to_string(k);
    const pid_t run = start(output);
    const double moment = whole * (k + std::uniform_real_distribution<double>()(random)) / 20;
    std::this_thread::sleep_for(std::chrono::duration<double>(moment));
    if (k % 4 == 3)
      kill(run, SIGKILL);  // kills the driver alone; the stage continues
    else
      kill(-run, SIGKILL);
    killed += wait_for(run) == 128 + SIGKILL;
    EXPECT_EQ(wait_for(start(output)), 0) << read_text(folder_ / (output + ".log"));
    expect_same_bits(output);
    fs::remove_all(folder_ / output);
  }
  EXPECT_GE(killed, 10) << "the other runs ended before the signal";
}

TEST_F(Kill, TwoConcurrentRunsOfOneJobDoNotInterfere) {
  const double whole = run_whole();
  for (const double part : {0.0, 0.3, 0.6}) {
    const std::string output = "both" + std::to_string(int(10 * part));
    const pid_t first = start(output);
    std::this_thread::sleep_for(std::chrono::duration<double>(part * whole));
    const pid_t second = start(output);
    EXPECT_EQ(wait_for(first), 0);
    EXPECT_EQ(wait_for(second), 0);
    expect_same_bits(output);
    const std::string log = read_text(folder_ / (output + ".log"));
    EXPECT_THAT(log, HasSubstr("waits for another run in")) << "the second run does not run the stages again";
    std::size_t solves = 0;
    for (std::size_t at = 0; (at = log.find("solve runs", at)) != std::string::npos; ++at) ++solves;
    EXPECT_EQ(solves, 1u) << log;
  }
}

TEST_F(Kill, RunsWithDifferentSettingsInOneFolderEachGetTheirOutput) {
  const double whole = run_whole();
  for (const double part : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    const std::string output = "mixed" + std::to_string(int(10 * part));
    const pid_t first = start(output);
    std::this_thread::sleep_for(std::chrono::duration<double>(part * whole));
    const pid_t second = start(output, "solve.rays=300");
    EXPECT_EQ(wait_for(first), 0);
    EXPECT_EQ(wait_for(second), 0);
    EXPECT_EQ(wait_for(start(output)), 0);
    expect_same_bits(output);
  }
}

// Stage programs themselves do not lock the output folder.
TEST_F(Kill, ConcurrentSolvesDoNotInterfere) {
  run_whole();
  fs::create_directory(folder_ / "both");
  fs::copy(folder_ / "whole/patches.h5", folder_ / "both/patches.h5");
  const std::string solve = quoted((fs::path(PATCHLIGHT_PROGRAMS) / "patchlight-solve").string()) +
                            " job.yaml --set solve.rays=1000 --output both --quiet";
  const std::string line =
      "cd " + quoted(folder_.path().string()) + " && { " + solve + " & " + solve + " & " + solve + " && wait; }";
  EXPECT_EQ(std::system(line.c_str()), 0);
  fs::copy(folder_ / "whole/frames", folder_ / "both/frames");
  expect_same_bits("both");
}

}  // namespace
}  // namespace patchlight::test
