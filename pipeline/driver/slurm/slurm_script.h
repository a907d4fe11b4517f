#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// The tasks of one stage.
struct SlurmStage {
  std::string name;                  ///< import, rows, solve or trace.
  std::vector<std::string> command;  ///< The program and its arguments, without `--shard` and `--log-json`.
  int shards = 0;                    ///< Number of shards, one a task; 0: a single task without shards.
  std::vector<int> tasks{1};         ///< Tasks to run, ascending.
};

/// How a task ended.
struct SlurmTaskEnd {
  int exit_code = 0;          ///< 128 + n after signal n.
  double begin = 0, end = 0;  ///< s since the epoch.
  double cpu_seconds = 0;
};

/// The folder of batch scripts and task files.
std::filesystem::path slurm_folder(const Job& job);

/// Our files in that folder.
std::vector<std::filesystem::path> slurm_files(const std::filesystem::path& folder);

/// A file that a task of a Slurm job writes: .log, its output; .jsonl, its JSON log; .end, its SlurmTaskEnd.
std::filesystem::path slurm_task_file(const std::filesystem::path& folder, const std::string& stage, int task,
                                      const std::string& job, const std::string& extension);

/// The batch script of a stage, whose tasks write into `folder`. File names are quoted for the shell.
std::string slurm_script(const SlurmStage& stage, const std::filesystem::path& folder);

/// Empty optional if the task has not ended.
std::optional<SlurmTaskEnd> read_task_end(const std::filesystem::path& file);

}  // namespace patchlight
