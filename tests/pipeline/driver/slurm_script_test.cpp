#include "pipeline/driver/slurm/slurm_script.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TemporaryFolder;

constexpr const char* kOdd = "it's %j \"$HOME\" \\n; `id` \n#SBATCH --array=7\n";

class SlurmScript : public ::testing::Test {
 protected:
  void SetUp() override {
    place_ = folder_ / kOdd;
    fs::create_directory(place_);
    program_ = place_ / "program";
    std::ofstream(program_) << "#!/bin/sh\nfor word; do printf '%s|' \"$word\"; done\neval \"$END\"\n";
    fs::permissions(program_, fs::perms::owner_all);
  }

  /// Runs the script as Slurm would, with what the program is to do in the end.
  int run(const SlurmStage& stage, const std::string& end) const {
    folder_.write("script", slurm_script(stage, place_));
    const std::string line = "END='" + end + "' SLURM_JOB_ID=12 SLURM_ARRAY_JOB_ID=11 SLURM_ARRAY_TASK_ID=3 sh '" +
                             (folder_ / "script").string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  }

  TemporaryFolder folder_;
  fs::path place_, program_;
};

TEST_F(SlurmScript, HandsAnyWordOnAsItIs) {
  const SlurmStage stage{"trace", {program_.string(), "--skip-fresh", kOdd, "", "-- $(exit 1)"}, 5, {3}};
  EXPECT_EQ(run(stage, "exit 0"), 0);
  const fs::path log = slurm_task_file(place_, "trace", 3, "11", "jsonl");
  EXPECT_EQ(read_text(slurm_task_file(place_, "trace", 3, "11", "log")),
            "--shard|3/5|--log-json|" + log.string() + "|--skip-fresh|" + kOdd + "||-- $(exit 1)|");
}

TEST_F(SlurmScript, LeavesHowItEnded) {
  const SlurmStage stage{"solve", {program_.string(), "job"}};
  const fs::path end = slurm_task_file(place_, "solve", 1, "12", "end");
  EXPECT_FALSE(read_task_end(end));
  EXPECT_EQ(run(stage, "exit 77"), 77);
  ASSERT_TRUE(read_task_end(end));
  EXPECT_EQ(read_task_end(end)->exit_code, 77);
  EXPECT_GT(read_task_end(end)->begin, 1e9);
  EXPECT_GE(read_task_end(end)->end, read_task_end(end)->begin);
  EXPECT_LT(read_task_end(end)->cpu_seconds, 10);
  EXPECT_EQ(run(stage, "kill -KILL $$"), 128 + 9);
  std::ofstream(end) << "0 100.5 102.25\n0m0.010s 0m0.020s\n1m2.500s 0m1.000s\n";
  EXPECT_DOUBLE_EQ(read_task_end(end)->cpu_seconds, 63.53);
  std::ofstream(end) << "0 100.5";
  EXPECT_FALSE(read_task_end(end)) << "half of it";
}

TEST_F(SlurmScript, FindsItsFilesAndNoOthers) {
  EXPECT_EQ(run({"rows", {program_.string()}, 5, {3}}, "exit 0"), 0);
  EXPECT_EQ(slurm_files(place_).size(), 2u);  // .log and .end; the program writes no .jsonl
  std::ofstream(place_ / "notes.txt") << "mine";
  std::ofstream(place_ / "rows.sh") << "";
  EXPECT_EQ(slurm_files(place_).size(), 3u);
}

}  // namespace
}  // namespace patchlight
