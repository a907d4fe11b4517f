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

/// Stages under Slurm, each after the one before it: submits them, waits, passes on what their tasks tell, and has
/// tasks that are lost or killed done again, alone.
///
/// How a task ended it reads from a file that the task writes, since not every cluster keeps accounts; Slurm is asked
/// now and then for tasks that end without.
class SlurmChain {
 public:
  /// `folder`: for scripts and logs, seen by all nodes. `retries`: how often a task is done again.
  SlurmChain(const SlurmClient& client, std::filesystem::path folder, int retries, Progress& progress)
      : client_(client), folder_(std::move(folder)), retries_(retries), progress_(progress) {}

  /// When all tasks of a stage had done well: seconds from the first's beginning to the last's end, and of CPU.
  using Done = std::function<void(const SlurmStage& stage, double wall_seconds, double cpu_seconds)>;

  /// Throws: Error with the exit code of a task that fails, naming its log; (interrupted) for a task that is lost again
  /// and again, and after SIGINT or SIGTERM; (unavailable) without Slurm. What is left is cancelled then.
  void run(const std::vector<SlurmStage>& stages, const Done& done);

  /// The stage that is under way, or failed.
  const std::string& stage() const { return stages_[front_].what.name; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Task {
    int index = 1;
    std::string job{};  ///< Empty: not submitted.
    int losses = 0;
    bool done = false;
    SlurmTaskEnd end{};
    double fraction = 0;       ///< As its log has it.
    std::streamoff heard = 0;  ///< Bytes of its log that were passed on.
    int unseen = 0;            ///< How many times Slurm did not know of it.
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
  std::size_t front_ = 0;  ///< The stage that is under way.
  Clock::time_point asked_{}, answered_{}, asked_to_submit_{};
  std::optional<Clock::time_point> refused_;  ///< Since when Slurm takes nothing more.
  std::string waits_for_;                     ///< What Slurm says that tasks wait for.
  std::set<std::string> warnings_;            ///< That were passed on.
};

}  // namespace patchlight
