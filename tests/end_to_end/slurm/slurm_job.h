#pragma once
#include <gmock/gmock.h>

#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "tests/end_to_end/background_program.h"
#include "tests/end_to_end/slurm/slurm_cluster.h"

namespace patchlight::test {

inline constexpr double kTimeout = 120;  // s; allows for a busy machine

/// Inode and modification time, which together tell files apart.
using Identity = std::pair<ino_t, std::int64_t>;

/// Runs a job on a Slurm cluster of the test.
class Slurm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!SlurmCluster::is_installed()) GTEST_SKIP() << "Slurm is not installed: run .ci/setup-slurm";
    const std::string fault = cluster_.start();
    ASSERT_EQ(fault, "");
    make_job(folder_.path());
  }

  /// Writes a Slurm job of configs/mirror_room.glb with three shards and a turntable camera. Returns its file.
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

  /// Starts `patchlight run` with its stderr in a file.
  pid_t start(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"run", (folder_ / "job.yaml").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    fs::remove(folder_ / "messages");
    return start_program("patchlight", arguments, folder_ / "messages");
  }

  std::string messages() const { return read_text(folder_ / "messages"); }

  /// Process id of a program of this test whose arguments contain `words`, separated by zero bytes; 0: none.
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

  /// Waits for the program of a task, stops it by SIGSTOP and returns its process id.
  pid_t stop(const std::string& program, const std::string& words) const {
    pid_t task = 0;
    EXPECT_TRUE(SlurmCluster::within(kTimeout, [&] {
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

  /// Adds the present identities of the shard files to `seen`.
  void record_identities(std::map<int, std::set<Identity>>& seen) const {
    for (int k = 1; k <= 3; ++k) {
      struct stat info;
      if (::stat(shard(k).c_str(), &info) == 0)
        seen[k].insert({info.st_ino, std::int64_t(info.st_mtim.tv_sec) * 1'000'000'000 + info.st_mtim.tv_nsec});
    }
  }

  /// Number of task logs whose names begin with `beginning`, such as `rows.2.`.
  int logs(const std::string& beginning) const {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "out/slurm"))
      count += entry.path().filename().string().starts_with(beginning) && entry.path().extension() == ".log";
    return count;
  }

  static bool queue_is_empty() { return SlurmCluster::output("squeue --noheader").empty(); }

  /// Compares the outputs of a job bit by bit with those of a local run.
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

  /// Stops the task of the second of three shards until the other two are complete, ends it by `kill_task`, and expects
  /// that only this shard is cast again.
  template <class Kill>
  void expect_one_shard_recast(Kill kill_task) {
    const pid_t driver = start();
    const pid_t task = stop("patchlight-solve", std::string("--shard\0002/3", 11));
    ASSERT_GT(task, 0);
    ASSERT_TRUE(SlurmCluster::within(kTimeout, [&] { return fs::exists(shard(1)) && fs::exists(shard(3)); }))
        << messages();
    EXPECT_FALSE(fs::exists(shard(2)));
    kill_task(task);
    std::map<int, std::set<Identity>> seen;
    int status = 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kTimeout);
    while (waitpid(driver, &status, WNOHANG) == 0) {
      ASSERT_LT(std::chrono::steady_clock::now(), end) << messages();
      record_identities(seen);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));  // a shard file that is replaced exists only briefly
    }
    EXPECT_EQ(exit_code(status), 0) << messages();
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

}  // namespace patchlight::test
