#pragma once
#include <string>
#include <vector>

namespace patchlight {

/// Runs `patchlight-STAGE` of this program's own folder and waits for it. SIGINT and SIGTERM are passed on to it
/// once Progress catches them.
/// Returns its exit code; 70 if it was killed.
/// Throws: Error (unavailable) if it cannot be started.
int run_stage_program(const std::string& stage, const std::vector<std::string>& arguments);

}  // namespace patchlight
