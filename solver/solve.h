#pragma once
#include "pipeline/files/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Irradiance that each light group of `scene` causes, directly and by reflection, by the method of `config`.
/// Throws: Error (bad_config) for a method that does not exist yet; (interrupted).
EnergyField solve(const PatchSet& scene, const SolveConfig& config, Progress& progress);

}  // namespace patchlight
