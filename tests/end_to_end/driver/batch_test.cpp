#include <gmock/gmock.h>

#include <regex>

#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

using ::testing::UnorderedElementsAre;

/// Numbers of the rendered frames, in order.
std::vector<int> rendered(const std::string& messages) {
  std::vector<int> frames;
  static const std::regex line("spin\\.(\\d{4})\\.exr in ");
  for (std::sregex_iterator i(messages.begin(), messages.end(), line), end; i != end; ++i)
    frames.push_back(std::stoi((*i)[1]));
  return frames;
}

/// A turntable camera of eight frames around the box.
class Batch : public ProgramTest {
 protected:
  void SetUp() override {
    small_job(folder_, "cameras:\n  spin: {look_from: [0, 0.28, 1.2], look_at: [0, 0.28, 0], turntable: 8}\n");
  }

  Outcome run(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"run", "job.yaml", "--set", "cache=0", "--set", "trace.cameras=[spin]"});
    return run_program(folder_, "patchlight", more);
  }
  Outcome run_frames(const std::string& frames) { return run({"--set", "trace.frames=" + frames}); }

  Outcome run_all(const std::string& samples) {
    return run({"--set", "trace.frames=1-8", "--set", "trace.samples=" + samples});
  }

  /// Command that renders those of eight frames that are not up to date on one thread. `messages`: file for its stderr.
  static std::string trace(const std::string& samples, const std::string& messages) {
    return quoted((std::filesystem::path(PATCHLIGHT_PROGRAMS) / "patchlight-trace").string()) +
           " --skip-fresh --threads 1 job.yaml --set trace.cameras=[spin] --set trace.frames=1-8 --set trace.samples=" +
           samples + " 2>" + messages;
  }
  int bash(const std::string& script) const {
    const std::string command = "cd " + quoted(folder_.path().string()) + "; " + script;
    return WEXITSTATUS(std::system(("bash -c " + quoted(command)).c_str()));
  }

  std::filesystem::path exr(int frame) const {
    return folder_ / ("out/frames/spin.000" + std::to_string(frame) + ".exr");
  }
};

TEST_F(Batch, RendersARangeInItsOrder) {
  const Outcome outcome = run_frames("5,1-3x2");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(rendered(outcome.err), (std::vector{5, 1, 3}));
  EXPECT_EQ(read_exr_header(exr(3)).metadata["Frame"], "0003");
  EXPECT_EQ(read_exr_header(exr(3)).metadata["Camera"], "spin");
  EXPECT_NE(read_exr(exr(1)).pixels, read_exr(exr(3)).pixels);
}

TEST_F(Batch, RendersOnlyFramesThatAreNotUpToDate) {
  ASSERT_EQ(run_frames("1-3").code, 0);
  Outcome outcome = run_frames("1-3");
  EXPECT_THAT(outcome.err, HasSubstr("trace skipped: up to date"));
  outcome = run_frames("2-5");
  EXPECT_EQ(rendered(outcome.err), (std::vector{4, 5}));
  EXPECT_THAT(outcome.err, HasSubstr("2 of 4 frames are up to date"));
  std::filesystem::remove(exr(2));
  folder_.write("out/frames/spin.0004.png", "");
  EXPECT_EQ(rendered(run_frames("1-5").err), (std::vector{2, 4}));
  EXPECT_EQ(rendered(run({"--force", "--set", "trace.frames=1-2"}).err), (std::vector{1, 2}));
}

TEST_F(Batch, RunsOnlyTheTraceForAnotherCamera) {
  ASSERT_EQ(run_frames("1-2").code, 0);
  const Outcome outcome = run({"--set", "cameras.spin.turntable=16", "--set", "trace.frames=1-2"});
  EXPECT_THAT(outcome.err, HasSubstr("import skipped"));
  EXPECT_THAT(outcome.err, HasSubstr("solve skipped"));
  EXPECT_EQ(rendered(outcome.err), std::vector{2}) << "the first frame is the same";
}

TEST_F(Batch, IsSharedByTwoProcesses) {
  ASSERT_EQ(run_frames("1").code, 0);
  EXPECT_EQ(bash(trace("256", "a.txt") + " & first=$!; " + trace("256", "b.txt") + " && wait $first"), 0);
  std::vector<int> frames = rendered(read_text(folder_ / "a.txt"));
  const std::vector<int> others = rendered(read_text(folder_ / "b.txt"));
  EXPECT_GT(frames.size(), 0u);
  EXPECT_GT(others.size(), 0u);
  frames.insert(frames.end(), others.begin(), others.end());
  EXPECT_THAT(frames, UnorderedElementsAre(1, 2, 3, 4, 5, 6, 7, 8)) << "each frame once";
  EXPECT_THAT(run_all("256").err, HasSubstr("trace skipped: up to date"));
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("claim")));
  const std::vector<Color> shared = read_exr(exr(8)).pixels;
  std::filesystem::remove(exr(8));
  ASSERT_EQ(rendered(run_all("256").err), std::vector{8});
  EXPECT_EQ(read_exr(exr(8)).pixels, shared);
}

TEST_F(Batch, ContinuesAfterAProcessWasKilledOrInterrupted) {
  ASSERT_EQ(run_frames("1").code, 0);
  for (const auto& [signal, code] : {std::pair("KILL", 137), std::pair("INT", 75)}) {
    // During the second frame or shortly after: the message about the first has appeared.
    EXPECT_EQ(
        bash(trace("1024", "stopped.txt") +
             " & until grep -q ' in ' stopped.txt; do sleep 0.02; done; sleep 0.05; kill -" + signal + " $!; wait $!"),
        code);
    const std::vector<int> before = rendered(read_text(folder_ / "stopped.txt"));
    ASSERT_LT(before.size(), 8u);
    const Outcome outcome = run_all("1024");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    for (const int frame : rendered(outcome.err)) EXPECT_THAT(before, Not(::testing::Contains(frame)));
    EXPECT_THAT(run_all("1024").err, HasSubstr("trace skipped: up to date"));
    std::filesystem::remove_all(folder_ / "out/frames");
  }
}

}  // namespace
}  // namespace patchlight::test
