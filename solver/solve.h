#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Irradiance by each light group of `scene`, direct and indirect, by the method of `config`. The matrix method and the
/// display solution use `transport` and add what is missing in it.
/// Throws: Error (unavailable) without OpenGL for hemicubes; (over_limit) for too little memory; (bad_data) for light
/// too strong for single precision; (interrupted).
EnergyField solve(const PatchSet& scene, const SolveConfig& config, Transport& transport, Progress& progress);

/// Solves from an empty transport.
EnergyField solve(const PatchSet& scene, const SolveConfig& config, Progress& progress);

}  // namespace patchlight
