#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct FromBlendCommand {
  std::string blend;
  bool force = false;
};

/// Writes the glTF scene and the job of a Blender file beside it, to keep and edit. A job that is there stays, unless
/// `force` is set. Throws: errors of export_blender_file(); Error (usage) if its name does not end in .blend.
int export_from_blend(const FromBlendCommand& command, Progress& progress);

}  // namespace patchlight
