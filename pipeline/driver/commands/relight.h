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

/// Makes those frames under other lights in <output>/relit/ that are not as the job makes them now, from the layers of
/// traced ones that are there, and says why; nothing else is run.
/// Goes on past a variant that fails. Returns the exit code of the first failure, else 0.
/// Throws: Error (bad_config, missing_input) for the job.
int relight_jobs(const RelightCommand& command, Progress& progress);

}  // namespace patchlight
