#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Irradiance that each light group of `scene` causes, directly and by reflection, by the method of `config`. The
/// method `matrix` takes from `transport` what it holds and adds what is missing; the other leaves it alone.
/// Throws: Error (unavailable) without OpenGL for hemicubes; (interrupted).
EnergyField solve(const PatchSet& scene, const SolveConfig& config, Transport& transport, Progress& progress);

/// The same without a transport to begin with.
EnergyField solve(const PatchSet& scene, const SolveConfig& config, Progress& progress);

}  // namespace patchlight
