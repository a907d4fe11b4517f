#include <gmock/gmock.h>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

using ::testing::StartsWith;

/// Prefix of a command that sends SIGTERM to it, but not to its children, after one second.
constexpr const char* kTermAfterASecond = "timeout --foreground --preserve-status -s TERM 1";

class ExitCode : public ProgramTest {
 protected:
  /// Expects an exit code, an error message that contains `text`, and no unfinished file.
  void expect(int code, const Outcome& outcome, const std::string& text) {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("error: "));
    EXPECT_THAT(outcome.err, HasSubstr(text));
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
      EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
  Outcome import(const std::vector<std::string>& arguments) {
    return run_program(folder_, "patchlight-import", arguments);
  }
};

TEST_F(ExitCode, Is0ForHelpAndVersion) {
  for (const char* program : {"patchlight", "patchlight-import", "patchlight-solve", "patchlight-trace"}) {
    EXPECT_EQ(run_program(folder_, program, {"--help"}).code, 0);
    EXPECT_THAT(run_program(folder_, program, {"--version"}).out, StartsWith("patchlight "));
  }
  EXPECT_THAT(import({"--help"}).out, HasSubstr("import.patch_area"));
}

TEST_F(ExitCode, Is0AndAWarningForASceneWithoutLight) {
  small_job(folder_, "materials: {light: {emission: [0, 0, 0]}}\n");
  const Outcome outcome = run_program(folder_, "patchlight", {"run", "job.yaml"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: nothing in the scene emits light"));
}

TEST_F(ExitCode, Is64ForWrongUsage) {
  small_job(folder_);
  expect(64, import({}), "JOB.yaml");
  expect(64, import({"job.yaml", "--colour"}), "--colour");
  expect(64, import({"job.yaml", "--set", "solve.rays"}), "--set");
  expect(64, import({"job.yaml", "--threads", "0"}), "--threads");
  expect(64, import({"job.yaml", "--output", ""}), "--output");
  expect(64, run_program(folder_, "patchlight", {"fly"}), "fly");
}

TEST_F(ExitCode, Is65ForABadScene) {
  small_job(folder_);
  folder_.write("box.glb", "glTF\2\0\0\0 not really");
  expect(65, import({"job.yaml"}), "box.glb");
  folder_.write("box.glb", R"({"asset": {"version": "2.0"}})");
  expect(65, import({"job.yaml"}), "box.glb");
}

TEST_F(ExitCode, Is65ForADamagedOrForeignFile) {
  small_job(folder_);
  ASSERT_EQ(run_program(folder_, "patchlight", {"run", "job.yaml"}).code, 0);
  // A solution of other patches.
  ASSERT_EQ(import({"job.yaml", "--set", "import.patch_area=0.02"}).code, 0);
  expect(65, run_program(folder_, "patchlight-trace", {"job.yaml"}), "another patch file");
  const std::string whole = read_text(folder_ / "out/patches.h5");
  folder_.write("out/patches.h5", whole.substr(0, whole.size() - 100));
  expect(65, run_program(folder_, "patchlight-solve", {"job.yaml"}), "patches.h5");
  folder_.write("out/patches.h5", "nonsense");
  expect(65, run_program(folder_, "patchlight-solve", {"job.yaml"}), "patches.h5");
}

TEST_F(ExitCode, Is66ForAMissingInput) {
  expect(66, import({"none.yaml"}), "none.yaml");
  small_job(folder_);
  expect(66, run_program(folder_, "patchlight-solve", {"job.yaml"}), "patches.h5");
  std::filesystem::remove(folder_ / "box.glb");
  expect(66, import({"job.yaml"}), "box.glb");
  expect(66, run_program(folder_, "patchlight", {"run", "job.yaml"}), "box.glb");
  expect(66, run_program(folder_, "patchlight", {"info", "none.h5"}), "none.h5");
  small_job(folder_);
  expect(66, import({"job.yaml", "--set", "environment.image=none.hdr"}), "none.hdr");
}

TEST_F(ExitCode, Is69WithoutOpenGl) {
  small_job(folder_);
  ASSERT_EQ(import({"job.yaml"}).code, 0);
  expect(69,
         run_program(folder_, "patchlight-solve", {"job.yaml", "--set", "solve.form_factors=hemicube"},
                     "__EGL_VENDOR_LIBRARY_FILENAMES=/none"),
         "solve.form_factors: rays");
}

TEST_F(ExitCode, Is73WhenTheOutputCannotBeMade) {
  small_job(folder_);
  folder_.write("taken", "");
  expect(73, import({"job.yaml", "--output", "taken"}), "--output");
  expect(73, import({"job.yaml", "--log-json", "none/log"}), "--log-json");
}

TEST_F(ExitCode, Is74WhenTheDiskIsFull) {
  small_job(folder_);
  // A limit on the file size simulates a full disk.
  const Outcome outcome = run_program(folder_, "patchlight-import", {"job.yaml"}, "ulimit -f 1; trap '' XFSZ;");
  expect(74, outcome, "cannot write");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/patches.h5"));
}

TEST_F(ExitCode, Is75AfterASignalAndKeepsThePreviousFile) {
  small_job(folder_);
  ASSERT_EQ(run_program(folder_, "patchlight", {"run", "job.yaml"}).code, 0);
  const std::string before = read_text(folder_ / "out/energy.h5");
  const Outcome outcome =
      run_program(folder_, "patchlight-solve", {"job.yaml", "--set", "solve.rays=1000000"}, kTermAfterASecond);
  expect(75, outcome, "interrupted");
  EXPECT_EQ(read_text(folder_ / "out/energy.h5"), before);
  // The signal reaches only the driver, which forwards it.
  expect(75, run_program(folder_, "patchlight", {"run", "job.yaml", "--set", "solve.rays=1000000"}, kTermAfterASecond),
         "patchlight-solve: error: interrupted");
  EXPECT_EQ(read_text(folder_ / "out/energy.h5"), before);
}

// A stage that is about to end may ignore the signal.
TEST_F(ExitCode, Is75AfterASignalThatTheStageIgnored) {
  small_job(folder_);
  ASSERT_EQ(import({"job.yaml"}).code, 0);
  std::filesystem::rename(folder_ / "out/patches.h5", folder_ / "patches.h5");
  std::filesystem::create_directory(folder_ / "bin");
  std::filesystem::copy(std::string(PATCHLIGHT_PROGRAMS) + "/patchlight", folder_ / "bin/patchlight");
  for (const auto& [stage, script] :
       {std::pair("import", "trap '' TERM; kill -TERM $PPID; sleep 0.2; cp patches.h5 out/patches.h5"),
        std::pair("solve", "touch solve_started"), std::pair("trace", "touch trace_started")}) {
    const auto file = folder_.write(std::string("bin/patchlight-") + stage, std::string("#!/bin/sh\n") + script + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  expect(75, run_program(folder_, (folder_ / "bin/patchlight").string(), {"run", "job.yaml"}),
         "patchlight-run: error: interrupted");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/patches.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "solve_started"));
}

TEST_F(ExitCode, Is70ForAStageOfAnotherVersion) {
  small_job(folder_);
  ASSERT_EQ(import({"job.yaml", "--set", "import.patch_area=0.02"}).code, 0);
  fs::rename(folder_ / "out/patches.h5", folder_ / "patches.h5");
  fs::create_directory(folder_ / "bin");
  for (const char* program : {"patchlight", "patchlight-solve", "patchlight-trace"})
    fs::copy(fs::path(PATCHLIGHT_PROGRAMS) / program, folder_ / "bin");
  const auto file = folder_.write("bin/patchlight-import", "#!/bin/sh\ncp patches.h5 out/patches.h5\n");
  fs::permissions(file, fs::perms::owner_all);
  expect(70, run_program(folder_, (folder_ / "bin/patchlight").string(), {"run", "job.yaml"}),
         "build all programs from one version");
}

TEST_F(ExitCode, Is77OverTheLimitOfPatches) {
  small_job(folder_);
  expect(77, import({"job.yaml", "--set", "import.max_patches=100"}), "import.max_patches");
}

TEST_F(ExitCode, Is77ForASolveThatNeedsMoreMemoryThanAllowed) {
  small_job(folder_);
  ASSERT_EQ(import({"job.yaml"}).code, 0);
  expect(77, run_program(folder_, "patchlight-solve", {"job.yaml", "--memory", "1MiB"}), "--memory allows");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/transport.h5"));
  EXPECT_EQ(run_program(folder_, "patchlight", {"run", "job.yaml", "--memory", "1MiB"}).code, 77);
  EXPECT_EQ(run_program(folder_, "patchlight-solve", {"job.yaml", "--memory", "1GiB"}).code, 0);
}

TEST_F(ExitCode, Is78ForABadJob) {
  small_job(folder_);
  expect(78, import({"job.yaml", "--set", "import.patch_aria=1"}), "import.patch_area");
  ASSERT_EQ(import({"job.yaml"}).code, 0);
  const auto solve = [&](const char* set) {
    return run_program(folder_, "patchlight-solve", {"job.yaml", "--set", set});
  };
  EXPECT_EQ(run_program(folder_, "patchlight-solve",
                        {"job.yaml", "--set", "solve.method=progressive", "--set", "solve.error_target=0.1"})
                .code,
            78);
  ASSERT_EQ(solve("solve.rays=16").code, 0);
  const auto trace = [&](const char* set) {
    return run_program(folder_, "patchlight-trace", {"job.yaml", "--set", set});
  };
  expect(78, trace("trace.cameras=[nobody]"), "the scene has: camera");
  expect(78, trace("lights.nobody.scale=2"), "lights.ceiling");
  expect(78, trace("trace.view=Sepia"), "ACES");
}

TEST_F(ExitCode, IsInTheJsonLog) {
  small_job(folder_);
  run_program(folder_, "patchlight-solve", {"job.yaml", "--log-json", "log"});
  EXPECT_THAT(read_text(folder_ / "log"), HasSubstr(R"("exit_code":66)"));
}

}  // namespace
}  // namespace patchlight::test
