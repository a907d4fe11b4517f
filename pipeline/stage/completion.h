#pragma once
#include <string>

#include "pipeline/stage/command_line.h"

namespace patchlight {

/// The completion script of a program for `bash` or `zsh`; empty for other shells.
std::string completion_script(const Command& program, const std::string& shell);

}  // namespace patchlight
