#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct InfoCommand {
  std::string file;
};

/// Describes a file. Returns an exit code. Throws: Error (missing_input, bad_data).
int show_info(const InfoCommand& command);

}  // namespace patchlight
