#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/stage/progress.h"
#include "solver/form_factors/form_factors.h"

namespace patchlight {

/// Progressive refinement (Cohen et al. 1988): shoots the emitters' light, then repeatedly the reflected light of the
/// patches with the most unshot power, until the residual is below `config.tolerance`.
///
/// By rays: every ray of a group carries about the same power, 1 / (config.rays * patches) of the group's emitted
/// power, so that dim groups and patches are no noisier than bright ones; a shot has at least 16 rays. By hemicubes: an
/// emitting patch shoots from several points, and early shots add the light that the patch is expected to receive
/// (overshooting: Feda and Purgathofer 1992); excess is later shot as negative light. Patches shoot in batches, in an
/// order that does not depend on the number of threads.
///
/// The light unshot at the end becomes an ambient irradiance of the patches that its group lights (Cohen et al. 1988,
/// with light that escapes).
///
/// The residual is that of R = rho D + rho F R for the reflected radiosity R: the norm of the unshot light over that of
/// rho D, largest of all groups.
/// Throws: Error (interrupted); (bad_data) if a light group is too strong for single precision.
EnergyField progressive_refinement(const PatchSet& scene, const SolveConfig& config, FormFactorSource& form_factors,
                                   Progress& progress);

}  // namespace patchlight
