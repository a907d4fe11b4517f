#pragma once
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct BatchCommand {
  std::vector<std::string> job_files;
  std::string variant;  ///< Glob; empty: all.
  bool force = false;
  bool explain = false;
  CommonOptions common;
};

/// Runs all variants of all jobs, also after failures, and prints a summary. Returns the exit code of the first
/// failure, else 0. Throws: Error (usage) for one output folder of several jobs, (interrupted).
int run_jobs(const BatchCommand& command, Progress& progress);

}  // namespace patchlight
