#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct RelightCommand {
  std::string job_file;
  std::string variant;  ///< Glob; empty: all.
  bool force = false;
  bool explain = false;
  CommonOptions common;
};

/// Makes the relit frames in <output>/relit/ that are not fresh, from the layers of existing traced frames, and prints
/// the reasons. Runs no stage. Continues after a failed variant. Returns the exit code of the first failure, else 0.
/// Throws: Error (bad_config, missing_input) for the job.
int relight_jobs(const RelightCommand& command, Progress& progress);

}  // namespace patchlight
