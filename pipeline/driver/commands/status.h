#pragma once
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct StatusCommand {
  std::vector<std::string> job_files;
  std::string variant;  ///< Glob; empty: all.
  CommonOptions common;
};

/// Prints a line for each stage and frame of all variants of all jobs: fresh, stale, missing or damaged, and the
/// reason. Runs and changes nothing. Returns 0 if all is fresh, else 1. Throws: Error (bad_config, missing_input) for
/// the job.
int show_status(const StatusCommand& command);

}  // namespace patchlight
