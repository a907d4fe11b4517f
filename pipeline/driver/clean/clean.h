#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct CleanCommand {
  std::string job_file;
  bool all = false;  ///< Also remove everything else that Patchlight wrote into the output folder.
  CommonOptions common;
};

/// Removes the outputs of earlier settings; prints the bytes freed and the number of other files that stay. Returns 0.
/// Throws: Error (bad_config, missing_input) for the job, (io_error).
int clean_job(const CleanCommand& command, Progress& progress);

}  // namespace patchlight
