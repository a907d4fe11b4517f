#include <gmock/gmock.h>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

/// Programs whose standard output or error is closed, or cannot be written.
class Streams : public ProgramTest {
 protected:
  void SetUp() override { small_job(folder_); }

  /// Exit code of a command line of ours, with its redirections.
  int run(const std::string& program, const std::string& words) {
    const std::string path = quoted((fs::path(PATCHLIGHT_PROGRAMS) / program).string());
    return exit_code(std::system(("cd " + quoted(folder_.path().string()) + " && " + path + " " + words).c_str()));
  }
};

TEST_F(Streams, StagesGoOnWithoutStandardError) {
  for (const char* redirection : {" 2>&-", " 2>/dev/full"}) {
    for (const char* program : {"patchlight-import", "patchlight-solve", "patchlight-trace"})
      EXPECT_EQ(run(program, std::string("job.yaml") + redirection), 0) << program << redirection;
    EXPECT_EQ(run("patchlight", std::string("run job.yaml --set solve.rays=80") + redirection), 0) << redirection;
    EXPECT_EQ(run("patchlight-import", std::string("none.yaml") + redirection), 66) << redirection;
    EXPECT_EQ(run("patchlight-import", std::string("--fly") + redirection), 64) << redirection;
    EXPECT_EQ(run("patchlight-import", std::string("job.yaml --log-json none/log") + redirection), 73) << redirection;
  }
}

// A file that took the number of a closed stream would receive its messages.
TEST_F(Streams, FilesAreWholeWhereAllStreamsAreClosed) {
  EXPECT_EQ(run("patchlight", "run job.yaml <&- >&- 2>&-"), 0);
  EXPECT_EQ(run("patchlight", "status job.yaml >status.txt"), 0) << read_text(folder_ / "status.txt");
}

TEST_F(Streams, OutputThatCannotBeWrittenIsAnError) {
  ASSERT_EQ(run("patchlight", "run job.yaml --quiet"), 0);
  for (const char* redirection : {" >&-", " >/dev/full"}) {
    for (const char* words : {"--help", "--version", "status job.yaml", "info out/patches.h5", "info box.glb",
                              "info out/frames/camera.0001.exr", "diff out/energy.h5 out/energy.h5"})
      EXPECT_EQ(run("patchlight", words + std::string(redirection) + " 2>message"), 74) << words << redirection;
    EXPECT_THAT(read_text(folder_ / "message"), HasSubstr("patchlight-diff: error: cannot write the output: "));
    EXPECT_EQ(run("patchlight-solve", "--help" + std::string(redirection) + " 2>&-"), 74) << redirection;
  }
}

TEST_F(Streams, MessagesHaveTheirFormat) {
  Outcome outcome = run_program(folder_, "patchlight-import", {"job.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, ContainsRegex("^patchlight-import: [0-9]+ triangles read as .*cameras\n$"));
  small_job(folder_, "materials: {light: {emission: [0, 0, 0]}}\n");
  ASSERT_EQ(run_program(folder_, "patchlight-import", {"job.yaml", "--quiet"}).err, "");
  outcome = run_program(folder_, "patchlight-solve", {"job.yaml", "--quiet"});
  EXPECT_THAT(outcome.err, ContainsRegex("^patchlight-solve: warning: nothing in the scene emits light.*\n$"));
  outcome = run_program(folder_, "patchlight-import", {"none.yaml"});
  EXPECT_EQ(outcome.err, "patchlight-import: error: missing job file (none.yaml): check the path\n");
}

TEST_F(Streams, ALogThatCannotBeWrittenIsAWarning) {
  const Outcome outcome = run_program(folder_, "patchlight-import", {"job.yaml", "--quiet", "--log-json", "/dev/full"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "patchlight-import: warning: cannot write the log (/dev/full): check the space on the disk\n");
}

}  // namespace
}  // namespace patchlight::test
