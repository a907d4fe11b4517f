#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct CleanCommand {
  std::string job_file;
  bool all = false;  ///< Also remove all else that Patchlight made in the output folder.
  CommonOptions common;
};

/// Removes outputs of earlier settings that a job keeps, and says how much room that made and how many files of others
/// stay. Returns 0.
/// Throws: Error (bad_config, missing_input) for the job, (io_error).
int clean_job(const CleanCommand& command, Progress& progress);

}  // namespace patchlight
