#pragma once
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Factor of each light group of the scene in a frame, from the job's lights. Shape: [light groups].
/// Throws: Error (bad_config) for an unknown light group.
std::vector<Color> light_settings(const Job& job, const PatchSet& scene, int frame);

/// Checks the names in a job. Throws: Error (bad_config) for an unknown light group or camera.
void check_names(const Job& job, const PatchSet& scene);

}  // namespace patchlight
