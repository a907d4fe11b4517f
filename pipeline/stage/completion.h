#pragma once
#include <string>

#include "pipeline/stage/command_line.h"

namespace patchlight {

/// The script with which a shell, `bash` or `zsh`, completes a program's command line; empty for other shells.
std::string completion_script(const Command& program, const std::string& shell);

}  // namespace patchlight
