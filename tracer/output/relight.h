#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Makes the job's frames anew, as EXR and PNG in its folder of relit frames, from those in its folder of frames that
/// were traced as it says but for `lights`, `trace.view` and `trace.exposure`: the beauty is the sum of their light
/// groups' layers, each times its setting. Layers that hold light by its way cannot be had from these and are left out.
/// A frame that cannot be used is named in a warning, and the others go on. `skip_fresh`: those that are there as the
/// job makes them now stay.
/// Throws: Error (bad_config) for an unknown camera, light group or view, or without the layer `light_groups`;
/// (missing_input, bad_data) in the end, if frames could not be used; (cannot_create, io_error, interrupted).
void relight_frames(const Job& job, const PatchSet& scene, bool skip_fresh, Progress& progress);

}  // namespace patchlight
