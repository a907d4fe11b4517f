#pragma once
#include <string>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A job file with the cameras, light groups and materials of `scene`, which was imported with all defaults. It renders
/// the same frames as the scene without a job. Settings in comments have their present values; explanations begin with
/// `##`, so that the job stays valid without its `# `. `scene_path`, `output`: paths to write into the job.
std::string starter_job(const std::string& scene_path, const std::string& output, const PatchSet& scene);

}  // namespace patchlight
