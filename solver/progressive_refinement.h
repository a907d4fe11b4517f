#pragma once
#include "pipeline/files/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Shoots the emitters' light, then again and again what the patches with the most unshot power reflect (Cohen et al.
/// 1988), until the residual is below `config.tolerance`.
///
/// Every ray of a group carries about the same power, 1 / (config.rays * patches) of what the group emits, so that dim
/// groups and dim patches are no noisier than bright ones; a shot takes 16 rays at least. Patches shoot in batches,
/// chosen, cast and summed in an order that does not depend on the number of threads.
///
/// The residual is that of R = rho D + rho F R for the reflected radiosity R: the norm of what is unshot over that of
/// rho D, the largest of all groups.
EnergyField progressive_refinement(const PatchSet& scene, const SolveConfig& config, Progress& progress);

}  // namespace patchlight
