#include <gmock/gmock.h>
#include <sys/stat.h>

#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_program;
using test::TemporaryFolder;
using ::testing::HasSubstr;

class Shards : public ::testing::Test {
 protected:
  void SetUp() override {
    test::small_job(folder_, "cameras:\n  spin: {look_from: [0, 0.28, 1.2], look_at: [0, 0.28, 0], turntable: 8}\n");
  }

  Outcome run(const std::string& program, std::vector<std::string> words) {
    words.insert(words.begin(), "job.yaml");
    return run_program(folder_, program, words);
  }
  Outcome solve(const std::vector<std::string>& words) { return run("patchlight-solve", words); }

  fs::path shard(int k, int count) const {
    return folder_ / ("out/transport." + std::to_string(k) + "-of-" + std::to_string(count) + ".h5");
  }

  static std::pair<ino_t, std::int64_t> identity(const fs::path& file) {
    struct stat info {};
    EXPECT_EQ(::stat(file.c_str(), &info), 0) << file;
    return {info.st_ino, std::int64_t(info.st_mtim.tv_sec) * 1'000'000'000 + info.st_mtim.tv_nsec};
  }

  TemporaryFolder folder_;
};

TEST_F(Shards, AreCastOnceAndMergeToTheBitsOfOneSolve) {
  ASSERT_EQ(run("patchlight-import", {}).code, 0);
  ASSERT_EQ(solve({}).code, 0);
  fs::rename(folder_ / "out", folder_ / "alone");
  ASSERT_EQ(run("patchlight-import", {}).code, 0);
  for (const char* k : {"1/3", "2/3", "3/3"}) EXPECT_EQ(solve({"--shard", k, "--threads=1"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/energy.h5"));
  EXPECT_EQ(run_program(folder_, "patchlight", {"info", shard(1, 3).string()}).code, 0);

  const auto first = identity(shard(1, 3)), second = identity(shard(2, 3));
  fs::remove(shard(3, 3));
  EXPECT_EQ(solve({"--merge=3"}).code, 66);
  for (const char* k : {"1/3", "2/3", "3/3"}) EXPECT_EQ(solve({"--shard", k}).code, 0);
  EXPECT_EQ(identity(shard(1, 3)), first) << "it was up to date";
  EXPECT_EQ(identity(shard(2, 3)), second) << "it was up to date";
  EXPECT_EQ(solve({"--shard=2/3", "--set=solve.rays=96"}).code, 0);
  EXPECT_NE(identity(shard(2, 3)), second);
  EXPECT_EQ(solve({"--merge=3"}).code, 65) << "shard 2 has other settings now";
  EXPECT_EQ(solve({"--shard=2/3"}).code, 0);

  const Outcome merged = solve({"--merge=3"});
  EXPECT_EQ(merged.code, 0) << merged.err;
  for (const char* file : {"energy.h5", "transport.h5"})
    EXPECT_EQ(
        run_program(folder_, "patchlight", {"diff", std::string("alone/") + file, std::string("out/") + file}).code, 0)
        << file;
  EXPECT_FALSE(fs::exists(shard(1, 3))) << "transport.h5 contains its rows";
  EXPECT_EQ(solve({"--merge=3"}).code, 0) << "nothing is left to merge";
}

TEST_F(Shards, OfFramesCoverAllFrames) {
  ASSERT_EQ(run("patchlight-import", {}).code, 0);
  ASSERT_EQ(solve({}).code, 0);
  const std::vector<std::string> frames{"--set=trace.cameras=[spin]", "--set=trace.frames=1-5"};
  const auto trace = [&](const std::string& shard) {
    return run("patchlight-trace", {frames[0], frames[1], "--skip-fresh", "--shard", shard}).err;
  };
  const std::string second = trace("2/2");
  EXPECT_THAT(second, HasSubstr("spin.0002.exr in "));
  EXPECT_THAT(second, HasSubstr("spin.0004.exr in "));
  EXPECT_FALSE(fs::exists(folder_ / "out/frames/spin.0001.exr"));
  trace("1/2");
  EXPECT_THAT(trace("1/2"), HasSubstr("3 of 3 frames are up to date"));
  EXPECT_THAT(trace("6/6"), HasSubstr("this shard has none of the 5 frames"));
  EXPECT_EQ(run_program(folder_, "patchlight", {"status", "job.yaml", frames[0], frames[1]}).code, 0);
}

TEST_F(Shards, AreRefusedForSolvesWithoutShards) {
  ASSERT_EQ(run("patchlight-import", {}).code, 0);
  for (const char* set : {"solve.method=progressive", "solve.form_factors=hemicube", "solve.error_target=0.01"})
    for (const char* option : {"--shard=1/2", "--merge=2"}) {
      const Outcome outcome = solve({option, "--set", set});
      EXPECT_EQ(outcome.code, 78) << set;
      EXPECT_THAT(outcome.err, HasSubstr(std::string(set).substr(0, std::string(set).find('='))));
    }
  for (const char* shard : {"0/2", "3/2", "1", "1/0", "1/1001", "a/b", "1/2/3", "-1/2", ""})
    EXPECT_EQ(solve({"--shard", shard}).code, 64) << shard;
  EXPECT_EQ(solve({"--shard=1/2", "--memory=1MiB"}).code, 77);
  const Outcome dark = solve({"--shard=1/2", "--output=dark"});
  EXPECT_EQ(dark.code, 66) << "no patches.h5";
}

TEST_F(Shards, OfASceneWithoutLightNeedNoRows) {
  const std::string dark = "--set=nodes.*.emission=[0, 0, 0]";
  ASSERT_EQ(run("patchlight-import", {dark}).code, 0);
  EXPECT_THAT(solve({"--shard=1/2", dark}).err, HasSubstr("no row is needed"));
  EXPECT_EQ(solve({"--merge=2", dark}).code, 0);
}

TEST_F(Shards, NeedARunningSlurm) {
  const auto run_by_slurm = [&](const std::string& path) {
    return run_program(folder_, "patchlight", {"run", "job.yaml", "--set=executor=slurm"}, "PATH=" + path);
  };
  Outcome outcome = run_by_slurm("/nowhere");
  EXPECT_EQ(outcome.code, 69) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("slurm-client"));
  fs::create_directory(folder_ / "bin");
  for (const char* name : {"bin/sbatch", "bin/scancel", "bin/squeue"}) {
    folder_.write(name, "#!/bin/sh\necho 'no such cluster' >&2\nexit 1\n");
    fs::permissions(folder_ / name, fs::perms::owner_all);
  }
  outcome = run_by_slurm((folder_ / "bin").string());
  EXPECT_EQ(outcome.code, 69) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("Slurm refuses the stage: no such cluster"));
  EXPECT_EQ(run_program(folder_, "patchlight", {"run", "job.yaml"}, "PATH=/nowhere").code, 0);
  EXPECT_EQ(run_by_slurm("/nowhere").code, 0) << "everything is up to date";
}

TEST_F(Shards, AreSubmittedAgainAfterSlurmLostThemAndRefusedASubmission) {
  fs::create_directory(folder_ / "bin");
  folder_.write("bin/sbatch", R"sh(#!/bin/sh
cd "$(dirname "$0")"
count=$(($(cat count 2>/dev/null || echo 0) + 1))
echo $count >count
for script; do :; done
case $count in
  2 | 3) echo $count ;; # the solve and the frames get lost
  4) echo 'Socket timed out' >&2; exit 1 ;;
  *) SLURM_JOB_ID=$count SLURM_ARRAY_JOB_ID=$count SLURM_ARRAY_TASK_ID=1 sh "$script" && echo $count ;;
esac
)sh");
  folder_.write("bin/scancel", "#!/bin/sh\necho \"$@\" >>\"$(dirname \"$0\")/cancelled\"\n");
  folder_.write("bin/squeue", "#!/bin/sh\n");
  for (const char* name : {"bin/sbatch", "bin/scancel", "bin/squeue"})
    fs::permissions(folder_ / name, fs::perms::owner_all);
  const Outcome outcome =
      run_program(folder_, "patchlight", {"run", "job.yaml", "--set=executor=slurm", "--set=slurm.shards=1"},
                  "PATH=" + (folder_ / "bin").string() + ":$PATH");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("`solve` was lost"));
  EXPECT_THAT(outcome.err, HasSubstr("Socket timed out"));
  EXPECT_EQ(test::read_text(folder_ / "bin/count"), "6\n");
  EXPECT_THAT(test::read_text(folder_ / "bin/cancelled"), HasSubstr("--quiet 3\n")) << "the stage after the lost one";
  EXPECT_EQ(run_program(folder_, "patchlight", {"status", "job.yaml"}).code, 0);
}

TEST_F(Shards, AreCleanedAway) {
  ASSERT_EQ(run("patchlight-import", {}).code, 0);
  ASSERT_EQ(solve({"--shard=1/2"}).code, 0);
  fs::create_directory(folder_ / "out/slurm");
  folder_.write("out/slurm/rows.1.12.log", "");
  EXPECT_EQ(run_program(folder_, "patchlight", {"clean", "job.yaml", "--all"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace patchlight
