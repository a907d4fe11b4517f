#include <gmock/gmock.h>

#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "tests/end_to_end/background_program.h"
#include "tests/end_to_end/slurm/slurm_cluster.h"

namespace patchlight {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::read_text;
using test::run_program;
using test::SlurmCluster;
using test::start_program;
using test::TemporaryFolder;
using test::wait_for;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kPatience = 120;  // s, on a busy machine

/// Inode and time of change: another pair, another file.
using Identity = std::pair<ino_t, std::int64_t>;

class Slurm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!SlurmCluster::is_installed()) GTEST_SKIP() << "Slurm is not installed: run .ci/setup-slurm";
    const std::string fault = cluster_.start();
    ASSERT_EQ(fault, "");
    make_job(folder_.path());
  }

  /// A job of a room with mirrors whose frames turn about it.
  static fs::path make_job(const fs::path& folder, const std::string& name = "job.yaml") {
    fs::copy_file(std::string(PATCHLIGHT_SOURCE) + "/configs/mirror_room.glb", folder / "room.glb");
    std::ofstream(folder / name) << "scene: room.glb\noutput: out\nimport: {patch_area: 0.05}\nsolve: {rays: 1000}\n"
                                    "cameras:\n  spin: {look_from: [0, 1, 2], look_at: [0, 1, 0], turntable: 8}\n"
                                    "trace: {cameras: [spin], frames: 1-4, resolution: [32, 32], samples: 4}\n"
                                    "executor: slurm\nslurm: {shards: 3}\n";
    return folder / name;
  }

  Outcome run(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"run", "job.yaml"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(folder_, "patchlight", words);
  }

  /// Starts `patchlight run`, whose messages go to a file.
  pid_t start(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"run", (folder_ / "job.yaml").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    fs::remove(folder_ / "messages");
    return start_program("patchlight", arguments, folder_ / "messages");
  }

  std::string messages() const { return read_text(folder_ / "messages"); }

  /// The process of a program of this test with these words in a row among its arguments; 0: none.
  pid_t find(const std::string& program, const std::string& words) const {
    std::error_code fault;
    for (fs::directory_iterator entry("/proc", fault), end; !fault && entry != end; entry.increment(fault)) {
      const std::string command = read_text(entry->path() / "cmdline");
      if (command.find(program + '\0') != std::string::npos && command.find('\0' + words) != std::string::npos &&
          command.find(folder_.path().string()) != std::string::npos)
        return pid_t(std::atoi(entry->path().filename().c_str()));
    }
    return 0;
  }

  /// Finds a task's program, holds it where it is, and returns its process.
  pid_t hold(const std::string& program, const std::string& words) const {
    pid_t task = 0;
    EXPECT_TRUE(SlurmCluster::within(kPatience, [&] {
      task = find(program, words);
      return task > 0 && ::kill(task, SIGSTOP) == 0;
    })) << messages();
    return task;
  }

  static pid_t parent(pid_t process) {
    const std::string stat = read_text("/proc/" + std::to_string(process) + "/stat");
    return pid_t(std::atoi(stat.c_str() + stat.rfind(')') + 4));
  }

  fs::path shard(int k) const { return folder_ / ("out/transport." + std::to_string(k) + "-of-3.h5"); }

  /// Adds the identities of shards as they stand now.
  void see(std::map<int, std::set<Identity>>& seen) const {
    for (int k = 1; k <= 3; ++k) {
      struct stat info;
      if (::stat(shard(k).c_str(), &info) == 0)
        seen[k].insert({info.st_ino, std::int64_t(info.st_mtim.tv_sec) * 1'000'000'000 + info.st_mtim.tv_nsec});
    }
  }

  /// Logs of a stage's tasks in `out`, as in `rows.2.`.
  int logs(const std::string& beginning) const {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "out/slurm"))
      count += entry.path().filename().string().starts_with(beginning) && entry.path().extension() == ".log";
    return count;
  }

  static bool queue_is_empty() { return SlurmCluster::output("squeue --noheader").empty(); }

  /// Compares the outputs of a job with those of a local run of it.
  static void expect_local_bits(const TemporaryFolder& folder, const std::string& job, const std::string& output) {
    const Outcome local = run_program(folder, "patchlight", {"run", job, "--output", "local", "--set=executor=local"});
    ASSERT_EQ(local.code, 0) << local.err;
    for (const char* file : {"patches.h5", "transport.h5", "energy.h5", "frames/spin.0001.exr", "frames/spin.0002.exr",
                             "frames/spin.0003.exr", "frames/spin.0004.exr"}) {
      const Outcome diff =
          run_program(folder, "patchlight", {"diff", std::string("local/") + file, output + "/" + file});
      EXPECT_EQ(diff.code, 0) << file << "\n" << diff.out << diff.err;
    }
    for (int k = 1; k <= 4; ++k) {
      const std::string png = "/frames/spin.000" + std::to_string(k) + ".png";
      EXPECT_EQ(read_text(folder / (output + png)), read_text(folder / ("local" + png))) << png;
    }
  }

  /// Holds the second of three shards half-way until the others are there, ends it by `kill_task`, and expects that it
  /// alone is cast again.
  template <class Kill>
  void expect_one_shard_again(Kill kill_task) {
    const pid_t driver = start();
    const pid_t task = hold("patchlight-solve", std::string("--shard\0002/3", 11));
    ASSERT_GT(task, 0);
    ASSERT_TRUE(SlurmCluster::within(kPatience, [&] { return fs::exists(shard(1)) && fs::exists(shard(3)); }))
        << messages();
    EXPECT_FALSE(fs::exists(shard(2)));
    kill_task(task);
    std::map<int, std::set<Identity>> seen;
    int status = 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPatience);
    while (waitpid(driver, &status, WNOHANG) == 0) {
      ASSERT_LT(std::chrono::steady_clock::now(), end) << messages();
      see(seen);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));  // a shard that is cast again stands for a moment
    }
    EXPECT_EQ(test::exit_code(status), 0) << messages();
    EXPECT_THAT(messages(), HasSubstr("task 2 of 3 of `rows` was "));
    EXPECT_EQ(seen[1].size(), 1u) << "it was cast again";
    EXPECT_EQ(seen[3].size(), 1u) << "it was cast again";
    EXPECT_EQ(logs("rows.1."), 1);
    EXPECT_EQ(logs("rows.2."), 2);
    EXPECT_EQ(logs("rows.3."), 1);
    expect_local_bits(folder_, "job.yaml", "out");
  }

  SlurmCluster cluster_;
  TemporaryFolder folder_;
};

TEST_F(Slurm, GivesTheBitsOfALocalRunWhateverFilesAreCalled) {
  const fs::path odd = folder_ / "it's %j \"$HOME\" \\n; exit 3 `id` \n#SBATCH --array=7\n ü";
  fs::create_directory(odd);
  make_job(odd, "the job's.yaml");
  const std::string line = "cd " + test::quoted(odd.string()) + " && " +
                           test::quoted((fs::path(PATCHLIGHT_PROGRAMS) / "patchlight").string());
  const std::string job = test::quoted("the job's.yaml");
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
  EXPECT_FALSE(fs::exists(odd / "out/transport.1-of-3.h5")) << "transport.h5 has all";
  EXPECT_THAT(in_odd("status " + job + "; echo code $?"), HasSubstr("code 0"));
  const std::string log = read_text(odd / "log");
  for (const char* stage : {"import", "solve", "trace"})
    EXPECT_THAT(log, HasSubstr("\"target\":\"" + std::string(stage) + "\"")) << log;
}

TEST_F(Slurm, RunsOnlyWhatIsStale) {
  const Outcome first =
      run({"--set=slurm.partition=other", "--set=slurm.time=1:00:00", "--set=slurm.options=[--nice=1]", "--threads=2"});
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(SlurmCluster::output("squeue --noheader --states=all --format='%P %C' | sort -u"), "other 2\n");
  const std::string jobs = SlurmCluster::output("squeue --noheader --states=all | wc -l");
  Outcome again = run();
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("solve skipped: up to date"));
  EXPECT_EQ(SlurmCluster::output("squeue --noheader --states=all | wc -l"), jobs) << "nothing is submitted";

  fs::remove(folder_ / "out/frames/spin.0002.exr");
  EXPECT_EQ(run({"--set", "cache=0"}).code, 0);
  EXPECT_EQ(logs("trace."), 1) << "of the task that has the frame";
  EXPECT_EQ(logs("rows."), 0);

  again = run({"--set", "materials.boards.reflectance=[0.2, 0.3, 0.4]"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("transport.1-of-3.h5"))) << "other colours cast no ray";
  EXPECT_THAT(again.err, HasSubstr("solve runs"));
  EXPECT_THAT(run().err, HasSubstr("solve restored, made before"));
  EXPECT_EQ(run({"--set=solve.method=progressive", "--set=solve.rays=64"}).code, 0);
  EXPECT_EQ(logs("rows."), 0) << "it is one task";
}

TEST_F(Slurm, DoesAKilledTaskAgainAlone) {
  expect_one_shard_again([](pid_t task) { ::kill(task, SIGKILL); });
}

TEST_F(Slurm, DoesALostTaskAgainAlone) {
  expect_one_shard_again([](pid_t task) {  // as if its node had gone, without a word
    const pid_t script = parent(task);
    ::kill(script, SIGKILL);
    ::kill(task, SIGKILL);
  });
}

TEST_F(Slurm, DoesACancelledTaskAgainAlone) {
  expect_one_shard_again([](pid_t task) {
    const auto running = [] { return SlurmCluster::output("squeue --noheader --array --states=running --format=%i"); };
    EXPECT_TRUE(SlurmCluster::within(kPatience, [&] { return running().ends_with("_2\n") && running().size() < 8; }));
    SlurmCluster::output("scancel " + running());
    ::kill(task, SIGCONT);
  });
}

TEST_F(Slurm, DoesAKilledTaskOfFramesAgain) {
  const pid_t driver = start();
  const pid_t task = hold("patchlight-trace", std::string("--shard\0003/3", 11));
  ASSERT_TRUE(SlurmCluster::within(kPatience, [&] { return fs::exists(folder_ / "out/frames/spin.0004.png"); }));
  ::kill(task, SIGKILL);
  EXPECT_EQ(wait_for(driver), 0) << messages();
  EXPECT_EQ(logs("trace.1."), 1);
  EXPECT_EQ(logs("trace.3."), 2);
  EXPECT_EQ(logs("solve.1."), 1);
  expect_local_bits(folder_, "job.yaml", "out");
}

TEST_F(Slurm, GivesUpATaskThatIsLostAgainAndAgain) {
  const pid_t driver = start({"--set", "slurm.retries=1"});
  for (int k = 0; k < 2; ++k) {
    pid_t task = 0;
    ASSERT_TRUE(SlurmCluster::within(kPatience, [&] {
      task = find("patchlight-solve", std::string("--shard\0001/3", 11));
      return task > 0 && ::kill(task, SIGKILL) == 0;
    })) << messages();
    SlurmCluster::within(kPatience, [&] { return ::kill(task, 0) != 0; });
  }
  EXPECT_EQ(wait_for(driver), 75);
  EXPECT_THAT(messages(), HasSubstr("task 1 of 3 of `rows` was killed, 2 times"));
  EXPECT_THAT(messages(), HasSubstr("out/slurm/rows.1."));
  EXPECT_TRUE(SlurmCluster::within(kPatience, queue_is_empty));
}

TEST_F(Slurm, PassesOnHowATaskFailsAndRunsNothingAfterIt) {
  const Outcome outcome = run({"--memory=1MiB", "--set=slurm.shards=2"});
  EXPECT_EQ(outcome.code, 77);
  EXPECT_THAT(outcome.err, HasSubstr("patchlight-solve: error: "));
  EXPECT_THAT(outcome.err, HasSubstr("--memory allows"));
  EXPECT_THAT(outcome.err, ::testing::ContainsRegex("patchlight-run: error: task [12] of 2 of `rows` failed with exit "
                                                    "code 77 \\(.*/out/slurm/rows\\.[12]\\.[0-9]+\\.log\\)"));
  EXPECT_TRUE(SlurmCluster::within(kPatience, queue_is_empty));
  EXPECT_EQ(logs("solve."), 0);
  EXPECT_EQ(logs("trace."), 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/energy.h5"));

  folder_.write("room.glb", "no scene");
  EXPECT_EQ(run().code, 65);
  EXPECT_EQ(run({"--set=slurm.partition=nowhere"}).code, 69);
  EXPECT_THAT(run({"--set=slurm.partition=nowhere"}).err, HasSubstr("Slurm refuses the stage: "));
}

TEST_F(Slurm, GoesOnAfterAnInterruptWhereItWas) {
  pid_t driver = start();
  pid_t task = hold("patchlight-solve", std::string("--shard\0002/3", 11));
  ASSERT_TRUE(SlurmCluster::within(kPatience, [&] { return fs::exists(shard(1)) && fs::exists(shard(3)); }));
  ::kill(driver, SIGINT);
  EXPECT_EQ(wait_for(driver), 75) << messages();
  ::kill(task, SIGCONT);
  EXPECT_TRUE(SlurmCluster::within(kPatience, queue_is_empty)) << "it is cancelled";

  driver = start();  // and one that is killed leaves its tasks to the next
  task = hold("patchlight-solve", std::string("--shard\0002/3", 11));
  EXPECT_EQ(logs("rows.1.") + logs("rows.3."), 0) << "they are there";
  ::kill(driver, SIGKILL);
  wait_for(driver);
  EXPECT_FALSE(queue_is_empty());
  driver = start();
  EXPECT_TRUE(SlurmCluster::within(kPatience, [&] {
    return SlurmCluster::output("squeue --noheader --states=all --format=%T").find("CANCELLED") != std::string::npos;
  }));
  ::kill(task, SIGCONT);
  EXPECT_EQ(wait_for(driver), 0) << messages();
  expect_local_bits(folder_, "job.yaml", "out");
}

}  // namespace
}  // namespace patchlight
