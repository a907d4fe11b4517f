#pragma once
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// What the job's lights multiply each group of the scene by. Shape: [light groups].
/// Throws: Error (bad_config) for a light group that the scene does not have.
std::vector<Color> light_settings(const Job& job, const PatchSet& scene);

/// Throws: Error (bad_config) for a light group or camera that the scene does not have.
void check_names(const Job& job, const PatchSet& scene);

}  // namespace patchlight
