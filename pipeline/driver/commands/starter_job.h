#pragma once
#include <string>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A job file with the cameras, light groups and materials of `scene`, as it was imported with all defaults. It makes
/// the frames that the scene alone makes. Settings that stand in comments have their present values; explanations begin
/// with `##`, so that the job stays valid when every `# ` is taken away. `scene_path`, `output`: as the job names them.
std::string starter_job(const std::string& scene_path, const std::string& output, const PatchSet& scene);

}  // namespace patchlight
