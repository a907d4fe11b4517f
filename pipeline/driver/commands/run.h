#pragma once
#include <string>

#include "pipeline/driver/stages/run_command.h"

namespace patchlight {

/// Starts the stages whose outputs do not match the job, in order, and says why; what was made before with the same
/// settings is put back instead. Returns the exit code of the first stage that fails, else 0. `account`, unless null:
/// is told what each stage did, in a few words.
int run_job(const RunCommand& command, Progress& progress, std::string* account = nullptr);

}  // namespace patchlight
