#include "pipeline/driver/stages/stage_program.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/expect_error.h"

namespace patchlight {
namespace {

ProgramRun shell(const std::string& command) {
  return run_program("sh", {"-c", command});
}

TEST(StageProgram, TellsHowAProgramEnded) {
  EXPECT_EQ(shell("exit 3").exit_code, 3);
  EXPECT_EQ(shell("kill -TERM $$").exit_code, int(ExitCode::interrupted));
  EXPECT_EQ(shell("kill -KILL $$").exit_code, int(ExitCode::internal));
  EXPECT_ERROR(run_program("/no/such/program", {}), ExitCode::unavailable, "/no/such/program");
}

TEST(StageProgram, CountsCpuSecondsApartFromTheClock) {
  const ProgramRun idle = shell("sleep 0.2");
  EXPECT_GT(idle.wall_seconds, 0.15);
  EXPECT_LT(idle.cpu_seconds, 0.1);
  EXPECT_GT(shell("i=0; while [ $i -lt 100000 ]; do i=$((i + 1)); done").cpu_seconds, 0.01);
}

TEST(StageProgram, MeasuresTheProgramsMemoryAndNotItsParents) {
  const std::vector<char> ours(std::size_t(300) << 20, 1);
  EXPECT_LT(shell("sleep 0.05").peak_bytes, std::int64_t(100) << 20) << ours.size();
  EXPECT_GT(shell("sleep 0.05").peak_bytes, 100 << 10);
}

}  // namespace
}  // namespace patchlight
