#include "tests/end_to_end/slurm/slurm_job.h"

namespace patchlight::test {
namespace {

TEST_F(Slurm, GivesTheBitsOfALocalRunForAnyFileNames) {
  const fs::path odd = folder_ / "it's %j \"$HOME\" \\n; exit 3 `id` \n#SBATCH --array=7\n ü";
  fs::create_directory(odd);
  make_job(odd, "the job's.yaml");
  const std::string line =
      "cd " + quoted(odd.string()) + " && " + quoted((fs::path(PATCHLIGHT_PROGRAMS) / "patchlight").string());
  const std::string job = quoted("the job's.yaml");
  const auto in_odd = [&](const std::string& words) { return SlurmCluster::output("(" + line + " " + words + ")"); };
  const std::string first = in_odd("run " + job + " --log-json log; echo code $?");
  EXPECT_THAT(first, HasSubstr("code 0"));
  EXPECT_THAT(first, HasSubstr("patchlight-import: "));
  EXPECT_THAT(first, HasSubstr("patchlight-solve: transport.2-of-3.h5: "));
  EXPECT_THAT(first, HasSubstr("spin.0004.exr in "));
  EXPECT_THAT(in_odd("run " + job + " --output local --set=executor=local; echo code $?"), HasSubstr("code 0"));
  for (const char* file : {"patches.h5", "transport.h5", "energy.h5", "frames/spin.0001.exr", "frames/spin.0004.exr"})
    EXPECT_THAT(in_odd(std::string("diff local/") + file + " out/" + file + "; echo code $?"), HasSubstr("code 0"))
        << file;
  EXPECT_FALSE(fs::exists(odd / "out/transport.1-of-3.h5")) << "transport.h5 contains its rows";
  EXPECT_THAT(in_odd("status " + job + "; echo code $?"), HasSubstr("code 0"));
  const std::string log = read_text(odd / "log");
  for (const char* stage : {"import", "solve", "trace"})
    EXPECT_THAT(log, HasSubstr("\"target\":\"" + std::string(stage) + "\"")) << log;
}

TEST_F(Slurm, RunsOnlyStaleStages) {
  const Outcome first =
      run({"--set=slurm.partition=other", "--set=slurm.time=1:00:00", "--set=slurm.options=[--nice=1]", "--threads=2"});
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(SlurmCluster::output("squeue --noheader --states=all --format='%P %C' | sort -u"), "other 2\n");
  const std::string jobs = SlurmCluster::output("squeue --noheader --states=all | wc -l");
  Outcome again = run();
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("solve skipped: up to date"));
  EXPECT_EQ(SlurmCluster::output("squeue --noheader --states=all | wc -l"), jobs) << "nothing was submitted";

  fs::remove(folder_ / "out/frames/spin.0002.exr");
  EXPECT_EQ(run({"--set", "cache=0"}).code, 0);
  EXPECT_EQ(logs("trace."), 1) << "only the task of this frame";
  EXPECT_EQ(logs("rows."), 0);

  again = run({"--set", "materials.boards.reflectance=[0.2, 0.3, 0.4]"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("transport.1-of-3.h5"))) << "other colours need no rays";
  EXPECT_THAT(again.err, HasSubstr("solve runs"));
  EXPECT_THAT(run().err, HasSubstr("solve restored, made before"));
  EXPECT_EQ(run({"--set=solve.method=progressive", "--set=solve.rays=64"}).code, 0);
  EXPECT_EQ(logs("rows."), 0) << "a progressive solve is one task";
}

TEST_F(Slurm, RepeatsOnlyAKilledTask) {
  expect_one_shard_recast([](pid_t task) { ::kill(task, SIGKILL); });
}

TEST_F(Slurm, RepeatsOnlyALostTask) {
  expect_one_shard_recast([](pid_t task) {  // as after the loss of its node
    const pid_t script = parent(task);
    ::kill(script, SIGKILL);
    ::kill(task, SIGKILL);
  });
}

TEST_F(Slurm, RepeatsOnlyACancelledTask) {
  expect_one_shard_recast([](pid_t task) {
    const auto running = [] { return SlurmCluster::output("squeue --noheader --array --states=running --format=%i"); };
    EXPECT_TRUE(SlurmCluster::within(kTimeout, [&] { return running().ends_with("_2\n") && running().size() < 8; }));
    SlurmCluster::output("scancel " + running());
    ::kill(task, SIGCONT);
  });
}

TEST_F(Slurm, RepeatsAKilledTaskOfFrames) {
  const pid_t driver = start();
  const pid_t task = stop("patchlight-trace", std::string("--shard\0003/3", 11));
  ASSERT_TRUE(SlurmCluster::within(kTimeout, [&] { return fs::exists(folder_ / "out/frames/spin.0004.png"); }));
  ::kill(task, SIGKILL);
  EXPECT_EQ(wait_for(driver), 0) << messages();
  EXPECT_EQ(logs("trace.1."), 1);
  EXPECT_EQ(logs("trace.3."), 2);
  EXPECT_EQ(logs("solve.1."), 1);
  expect_local_bits(folder_, "job.yaml", "out");
}

TEST_F(Slurm, GivesUpATaskThatIsKilledRepeatedly) {
  const pid_t driver = start({"--set", "slurm.retries=1"});
  for (int k = 0; k < 2; ++k) {
    pid_t task = 0;
    ASSERT_TRUE(SlurmCluster::within(kTimeout, [&] {
      task = find("patchlight-solve", std::string("--shard\0001/3", 11));
      return task > 0 && ::kill(task, SIGKILL) == 0;
    })) << messages();
    SlurmCluster::within(kTimeout, [&] { return ::kill(task, 0) != 0; });
  }
  EXPECT_EQ(wait_for(driver), 75);
  EXPECT_THAT(messages(), HasSubstr("task 1 of 3 of `rows` was killed, 2 times"));
  EXPECT_THAT(messages(), HasSubstr("out/slurm/rows.1."));
  EXPECT_TRUE(SlurmCluster::within(kTimeout, queue_is_empty));
}

TEST_F(Slurm, ReportsAFailedTaskAndRunsNothingAfterIt) {
  const Outcome outcome = run({"--memory=1MiB", "--set=slurm.shards=2"});
  EXPECT_EQ(outcome.code, 77);
  EXPECT_THAT(outcome.err, HasSubstr("patchlight-solve: error: "));
  EXPECT_THAT(outcome.err, HasSubstr("--memory allows"));
  EXPECT_THAT(outcome.err, ContainsRegex("patchlight-run: error: task [12] of 2 of `rows` failed with exit "
                                         "code 77 \\(.*/out/slurm/rows\\.[12]\\.[0-9]+\\.log\\)"));
  EXPECT_TRUE(SlurmCluster::within(kTimeout, queue_is_empty));
  EXPECT_EQ(logs("solve."), 0);
  EXPECT_EQ(logs("trace."), 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/energy.h5"));

  folder_.write("room.glb", "no scene");
  EXPECT_EQ(run().code, 65);
  EXPECT_EQ(run({"--set=slurm.partition=nowhere"}).code, 69);
  EXPECT_THAT(run({"--set=slurm.partition=nowhere"}).err, HasSubstr("Slurm refuses the stage: "));
}

TEST_F(Slurm, ContinuesAfterAnInterrupt) {
  pid_t driver = start();
  pid_t task = stop("patchlight-solve", std::string("--shard\0002/3", 11));
  ASSERT_TRUE(SlurmCluster::within(kTimeout, [&] { return fs::exists(shard(1)) && fs::exists(shard(3)); }));
  ::kill(driver, SIGINT);
  EXPECT_EQ(wait_for(driver), 75) << messages();
  ::kill(task, SIGCONT);
  EXPECT_TRUE(SlurmCluster::within(kTimeout, queue_is_empty)) << "its tasks are cancelled";

  driver = start();  // a killed driver leaves its tasks to the next run
  task = stop("patchlight-solve", std::string("--shard\0002/3", 11));
  EXPECT_EQ(logs("rows.1.") + logs("rows.3."), 0) << "these shards are complete";
  ::kill(driver, SIGKILL);
  wait_for(driver);
  EXPECT_FALSE(queue_is_empty());
  driver = start();
  EXPECT_TRUE(SlurmCluster::within(kTimeout, [&] {
    return SlurmCluster::output("squeue --noheader --states=all --format=%T").find("CANCELLED") != std::string::npos;
  }));
  ::kill(task, SIGCONT);
  EXPECT_EQ(wait_for(driver), 0) << messages();
  expect_local_bits(folder_, "job.yaml", "out");
}

}  // namespace
}  // namespace patchlight::test
