#pragma once
#include <vector>

#include "pipeline/files/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Throws: Error (bad_config) for settings of `solve` that no solver can follow yet.
void check_available(const SolveConfig& solve);

/// Whether rows of form factors can be cast by several tasks.
bool is_shardable(const SolveConfig& solve);

/// Throws: Error (bad_config) where they cannot.
void check_shardable(const Job& job);

/// What the job's lights multiply each group of the scene by. Shape: [light groups].
/// Throws: Error (bad_config) for a light group that the scene does not have.
std::vector<Color> light_settings(const Job& job, const PatchSet& scene);

/// Throws: Error (bad_config) for a light group or camera that the scene does not have.
void check_names(const Job& job, const PatchSet& scene);

}  // namespace patchlight
