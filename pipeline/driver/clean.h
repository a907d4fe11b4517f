#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct CleanCommand {
  std::string job_file;
  bool all = false;  ///< Also what stands in the output folder.
  CommonOptions common;
};

/// Removes outputs of earlier settings that a job keeps, and says how much room that made. Returns 0.
/// Throws: Error (bad_config, missing_input) for the job, (io_error).
int clean_job(const CleanCommand& command, Progress& progress);

}  // namespace patchlight
