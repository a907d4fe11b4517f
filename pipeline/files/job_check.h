#pragma once
#include "pipeline/files/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Throws: Error (bad_config) for settings of `solve` that no solver can follow yet.
void check_available(const SolveConfig& solve);

/// Throws: Error (bad_config) for a light group or camera that the scene does not have.
void check_names(const Job& job, const PatchSet& scene);

}  // namespace patchlight
