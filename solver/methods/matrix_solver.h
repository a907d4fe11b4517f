#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Solves H = F rho (D + H) for the indirect irradiance H, with the form factors F and the emitters' direct irradiance
/// D from `transport`. Missing rows and emitters are sampled with `rays` rays a row and added to it. Light of emitters
/// by specular reflection counts as indirect. Throws: Error (interrupted); (unavailable) without OpenGL for hemicubes.
EnergyField solve_matrix(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                         Progress& progress);

}  // namespace patchlight
