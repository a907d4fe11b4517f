#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// Slurm's own programs, for the jobs of one output folder: these have names of its own, by which jobs are found again
/// that a killed run has left.
class SlurmClient {
 public:
  struct Request {
    std::string stage;
    std::filesystem::path script;
    std::vector<int> tasks;          ///< Of an array, ascending; empty: a job of one task.
    std::vector<std::string> after;  ///< Jobs and tasks that must have done well before.
  };

  /// What Slurm says of a task.
  struct TaskState {
    std::string name;     ///< As in RUNNING.
    std::string reason;   ///< Why it waits.
    bool active = false;  ///< It runs, or will.
  };

  SlurmClient(const Job& job, int cpus);

  /// Returns the job's number. Throws: Error (unavailable) without Slurm, or if it refuses the job; (interrupted).
  std::string submit(const Request& request) const;

  /// By `12` or, of an array, `12_3`: what is queued, runs, or ended not long ago; nothing if Slurm does not answer.
  std::optional<std::map<std::string, TaskState>> states() const;

  /// All jobs of this folder. Throws: Error (unavailable) without Slurm.
  void cancel() const;
  void cancel(const std::vector<std::string>& jobs) const;

 private:
  std::string name(const std::string& stage) const { return "patchlight-" + stage + "-" + folder_; }
  std::string names() const;

  SlurmConfig config_;
  int cpus_;
  std::string folder_;  ///< Short for the output folder.
};

}  // namespace patchlight
