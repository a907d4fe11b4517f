#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>

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
                              "info out/frames/camera.0001.exr", "init box.glb", "diff out/energy.h5 out/energy.h5"})
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

TEST_F(Streams, ALogIsAppendedToALogAlone) {
  const auto import_with_log = [&](const std::string& log) {
    return run_program(folder_, "patchlight-import", {"job.yaml", "--log-json", log});
  };
  for (const std::string content : {"a = 1\n", "{\"color\": 1}\n", "[]", "{\"stage\"", "\n"}) {
    folder_.write("mine", content);
    const Outcome outcome = import_with_log("mine");
    EXPECT_EQ(outcome.code, 73);
    EXPECT_EQ(outcome.err,
              "patchlight-import: error: not a JSON log of Patchlight (mine): choose another --log-json\n");
    EXPECT_EQ(read_text(folder_ / "mine"), content);
  }
  folder_.write("log", "");
  for (const char* log : {"log", "log", "new", "/dev/null"}) EXPECT_EQ(import_with_log(log).code, 0) << log;
  const std::string lines = read_text(folder_ / "log");
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2);
  EXPECT_EQ(run("patchlight-import", "job.yaml --log-json /dev/stdout 2>&- | grep -q '\"level\":\"note\"'"), 0);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  const int reader = open((folder_ / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
  EXPECT_EQ(import_with_log("pipe").code, 0);
  std::array<char, 8> begin{};
  EXPECT_EQ(read(reader, begin.data(), begin.size()), 8);
  EXPECT_EQ(begin.front(), '{');
  close(reader);
}

}  // namespace
}  // namespace patchlight::test
