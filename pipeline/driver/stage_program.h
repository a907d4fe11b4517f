#pragma once
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

/// A stage's arguments for a job under the driver's own options.
std::vector<std::string> stage_arguments(const std::string& job_file, const CommonOptions& options);

/// Runs `patchlight-STAGE` of this program's own folder and waits for it. SIGINT and SIGTERM are passed on to it.
/// Returns its exit code; 70 if it was killed.
/// Throws: Error (unavailable) if it cannot be started.
int run_stage_program(const std::string& stage, const std::vector<std::string>& arguments);

}  // namespace patchlight
