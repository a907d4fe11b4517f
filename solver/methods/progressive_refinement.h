#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/stage/progress.h"
#include "solver/form_factors/form_factors.h"

namespace patchlight {

/// Shoots the emitters' light, then again and again what the patches with the most unshot power reflect (Cohen et al.
/// 1988), until the residual is below `config.tolerance`.
///
/// By rays: every ray of a group carries about the same power, 1 / (config.rays * patches) of what the group emits, so
/// that dim groups and dim patches are no noisier than bright ones; a shot takes 16 rays at least. By hemicubes: an
/// emitting patch shoots from several of its points, and early shots give more than is unshot, by what the patch is
/// about to receive (overshooting: Feda and Purgathofer 1992); what was too much is shot as negative light. Patches
/// shoot in batches, chosen, cast and summed in an order that does not depend on the number of threads.
///
/// What is unshot in the end counts as an ambient irradiance of the patches that its group reaches (Cohen et al. 1988,
/// with the part of the light that escapes).
///
/// The residual is that of R = rho D + rho F R for the reflected radiosity R: the norm of what is unshot over that of
/// rho D, the largest of all groups.
EnergyField progressive_refinement(const PatchSet& scene, const SolveConfig& config, FormFactorSource& form_factors,
                                   Progress& progress);

}  // namespace patchlight
