#pragma once
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/driver/slurm/slurm_client.h"
#include "pipeline/driver/slurm/slurm_script.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Runs a chain of stages under Slurm: submits them, waits, forwards the messages of their tasks, and resubmits single
/// tasks that were lost or killed.
///
/// Each task writes its exit status to a file, because not every cluster has an accounting database. squeue is polled
/// for tasks that ended without writing the file.
class SlurmChain {
 public:
  /// `folder`: for scripts and logs, visible to all nodes. `retries`: how often a task is resubmitted.
  SlurmChain(const SlurmClient& client, std::filesystem::path folder, int retries, Progress& progress)
      : client_(client), folder_(std::move(folder)), retries_(retries), progress_(progress) {}

  /// Called when all tasks of a stage have succeeded: seconds from the first start to the last end, and CPU seconds.
  using Done = std::function<void(const SlurmStage& stage, double wall_seconds, double cpu_seconds)>;

  /// Throws: Error with the exit code of a failed task, naming its log; (interrupted) if a task is lost more than
  /// `retries` times, and after SIGINT or SIGTERM; (unavailable) without Slurm. Cancels the remaining tasks first.
  void run(const std::vector<SlurmStage>& stages, const Done& done);

  /// The running or failed stage.
  const std::string& stage() const { return stages_[front_].what.name; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Task {
    int index = 1;
    std::string job{};  ///< Empty: not submitted.
    int losses = 0;
    bool done = false;
    SlurmTaskEnd end{};
    double fraction = 0;       ///< Progress, from its log.
    std::streamoff heard = 0;  ///< Bytes of its log that were forwarded.
    int unseen = 0;            ///< Consecutive squeue answers without this task.
    bool runs = false;
  };
  struct Stage {
    SlurmStage what;
    std::vector<Task> tasks;
    bool is_array() const { return what.shards > 0; }
    bool done() const;
    bool submitted() const;
  };

  void submit_from(std::size_t first);
  void submit_again();
  bool advance(const Done& done);
  void look_at(Stage& stage, Task& task);
  void ask_slurm(Stage& stage);
  void listen(const Stage& stage, Task& task);
  void lose(const Stage& stage, Task& task, const std::string& how);
  void show(const Stage& stage);
  std::string name(const Stage& stage, const Task& task) const;
  std::filesystem::path file(const Stage& stage, const Task& task, const std::string& extension) const;
  std::string id(const Stage& stage, const Task& task) const;

  const SlurmClient& client_;
  const std::filesystem::path folder_;
  const int retries_;
  Progress& progress_;
  std::vector<Stage> stages_;
  std::size_t front_ = 0;  ///< Index of the running stage.
  Clock::time_point asked_{}, answered_{}, asked_to_submit_{};
  std::optional<Clock::time_point> refused_;  ///< Since when sbatch refuses jobs.
  std::string waits_for_;                     ///< Reason that squeue gives for pending tasks.
  std::set<std::string> warnings_;            ///< Forwarded warnings.
};

}  // namespace patchlight
