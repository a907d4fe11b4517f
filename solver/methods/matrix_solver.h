#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Solves H = F rho (D + H) for the indirect irradiance H, with rows F of form factors and the emitters' direct
/// irradiance D from `transport`; what it does not hold yet of the scene, with `rays` a row, is cast and added. Light
/// that reaches a patch from an emitter by way of mirrors counts as indirect. Throws: Error (interrupted);
/// (unavailable) without OpenGL for hemicubes.
EnergyField solve_matrix(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                         Progress& progress);

}  // namespace patchlight
