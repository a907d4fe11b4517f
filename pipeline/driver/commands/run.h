#pragma once
#include <string>

#include "pipeline/driver/stages/run_command.h"

namespace patchlight {

/// Runs the stages whose outputs are not fresh, in order, and prints the reasons; outputs in the cache are restored
/// instead. Returns the exit code of the first failed stage, else 0. `account`: receives a short text on each stage;
/// may be null.
int run_job(const RunCommand& command, Progress& progress, std::string* account = nullptr);

}  // namespace patchlight
