#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// Calls sbatch, squeue and scancel for the jobs of one output folder. Job names contain a hash of the folder, so that
/// the jobs of a killed run are found again.
class SlurmClient {
 public:
  struct Request {
    std::string stage;
    std::filesystem::path script;
    std::vector<int> tasks;          ///< Array indices, ascending; empty: a job of one task.
    std::vector<std::string> after;  ///< Jobs and tasks that must have succeeded before.
  };

  /// State of a task, from squeue.
  struct TaskState {
    std::string name;     ///< For example RUNNING.
    std::string reason;   ///< Why it is pending.
    bool active = false;  ///< Running or pending.
  };

  SlurmClient(const Job& job, int cpus);

  /// Returns the job id. Throws: Error (unavailable) without Slurm, or if sbatch refuses the job; (interrupted).
  std::string submit(const Request& request) const;

  /// States by job id (`12`, or `12_3` for an array task): pending, running or recently ended. Empty optional if Slurm
  /// does not answer.
  std::optional<std::map<std::string, TaskState>> states() const;

  /// Cancels all jobs of this folder. Throws: Error (unavailable) without Slurm.
  void cancel() const;
  void cancel(const std::vector<std::string>& jobs) const;

 private:
  std::string name(const std::string& stage) const { return "patchlight-" + stage + "-" + folder_; }
  std::string names() const;

  SlurmConfig config_;
  int cpus_;
  std::string folder_;  ///< Hash of the output folder.
};

}  // namespace patchlight
