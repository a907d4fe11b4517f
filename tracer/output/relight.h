#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Writes relit frames, EXR and PNG, into the job's relit folder without tracing: each is the sum of the light group
/// layers of a traced frame, each times its setting. The traced frame may differ from the job in `lights` and
/// `trace.picture` only. Layers by transport path (direct, indirect, ...) are left out, since light groups cannot give
/// them. Warns of each frame that cannot be used and continues. `skip_fresh`: keeps relit frames that are up to date.
/// Throws: Error (bad_config) for an unknown camera, light group or view, or without the layer `light_groups`;
/// (missing_input, bad_data) at the end if frames could not be used; (cannot_create, io_error, interrupted).
void relight_frames(const Job& job, const PatchSet& scene, bool skip_fresh, Progress& progress);

}  // namespace patchlight
