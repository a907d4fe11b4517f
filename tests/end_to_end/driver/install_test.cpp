#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

/// An installation of this build in a folder of the test's own.
class Install : public ProgramTest {
 protected:
  void SetUp() override {
    const fs::path build = fs::path(PATCHLIGHT_PROGRAMS).parent_path();
    const std::string command = "cmake --install " + quoted(build.string()) + " --prefix " +
                                quoted((folder_ / "first").string()) + " >" + quoted((folder_ / "log.txt").string()) +
                                " 2>&1";
    ASSERT_EQ(exit_code(std::system(command.c_str())), 0) << read_text(folder_ / "log.txt");
    fs::rename(folder_ / "first", folder_ / "moved");
    small_job(folder_);
  }

  /// A run of the installed driver.
  Outcome run() { return run_program(folder_, (folder_ / "moved/bin/patchlight").string(), {"run", "job.yaml"}); }
};

TEST_F(Install, RunsFromAnyFolder) {
  const Outcome outcome = run();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/frames/camera.0001.png"));
  for (const char* file : {"bash-completion/completions/patchlight", "zsh/site-functions/_patchlight-solve",
                           "doc/patchlight/copyright", "doc/patchlight/examples/cornell_box.yaml"})
    EXPECT_TRUE(fs::exists(folder_ / "moved/share" / file)) << file;
}

TEST_F(Install, ProgramsSayHowToMendAMissingModule) {
  fs::remove_all(folder_ / "moved/lib");
  small_job(folder_, "environment: {image: sky.hdr}\n");
  folder_.write("sky.hdr", "#?RADIANCE");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.code, 70);
  EXPECT_THAT(outcome.err, HasSubstr("moved/lib/patchlight/patchlight-textures.so"));
  EXPECT_THAT(outcome.err, HasSubstr("keep bin/ and lib/ together when you move Patchlight, or install it again"));
}

using Version = ProgramTest;

TEST_F(Version, NamesTheCommitOfACheckout) {
  const std::string source = quoted(PATCHLIGHT_SOURCE);
  const std::string command =
      "git -C " + source + " rev-parse --short=10 HEAD >" + quoted((folder_ / "commit.txt").string()) + " 2>/dev/null";
  if (std::system(command.c_str()) != 0) GTEST_SKIP() << "not built from a checkout";
  std::string commit = read_text(folder_ / "commit.txt");
  commit.pop_back();
  for (const char* program : {"patchlight", "patchlight-import", "patchlight-solve", "patchlight-trace"})
    EXPECT_THAT(run_program(folder_, program, {"--version"}).out, HasSubstr(" (" + commit)) << program;
}

}  // namespace
}  // namespace patchlight::test
