#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// A stage's tasks as Slurm is to run them.
struct SlurmStage {
  std::string name;                  ///< import, rows, solve or trace.
  std::vector<std::string> command;  ///< The program and its arguments, but for `--shard` and its log.
  int shards = 0;                    ///< Of how many shards each task does one; 0: a single task does all.
  std::vector<int> tasks{1};         ///< Which are to run, ascending.
};

/// What a task left when it ended.
struct SlurmTaskEnd {
  int exit_code = 0;          ///< 128 + n after signal n.
  double begin = 0, end = 0;  ///< s since the epoch.
  double cpu_seconds = 0;
};

/// Where scripts and what tasks write stand.
std::filesystem::path slurm_folder(const Job& job);

/// What stands there of ours.
std::vector<std::filesystem::path> slurm_files(const std::filesystem::path& folder);

/// Where a task of a Slurm job writes: .log, all that it prints; .jsonl, its JSON log; .end, how it ended.
std::filesystem::path slurm_task_file(const std::filesystem::path& folder, const std::string& stage, int task,
                                      const std::string& job, const std::string& extension);

/// The batch script of a stage, whose tasks write into `folder`. Any name of a file may stand in it.
std::string slurm_script(const SlurmStage& stage, const std::filesystem::path& folder);

/// Nothing while a task has not ended.
std::optional<SlurmTaskEnd> read_task_end(const std::filesystem::path& file);

}  // namespace patchlight
