#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct InitCommand {
  std::string scene;
  CommonOptions common;
};

/// Prints starter_job() of a scene. Imports the scene into a temporary folder unless the
/// patches in its own output folder are up to date. Returns the exit code of the import if that fails, else 0.
/// Throws: Error (usage) if the file is not a scene; (missing_input, cannot_create).
int print_starter_job(const InitCommand& command, Progress& progress);

}  // namespace patchlight
