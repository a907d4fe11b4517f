#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct InitCommand {
  std::string scene;
  CommonOptions common;
};

/// Prints a job for a scene: what `starter_job` makes of it. Imports the scene into a temporary folder unless the
/// patches in its own output folder are up to date. Returns the exit code of the import if that fails, else 0.
/// Throws: Error (usage) for what is not a scene; (missing_input, cannot_create).
int print_starter_job(const InitCommand& command, Progress& progress);

}  // namespace patchlight
