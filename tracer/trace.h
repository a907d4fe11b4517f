#pragma once
#include "pipeline/files/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Renders every frame of the job into its folder of frames, as EXR and PNG.
/// Throws: Error (bad_config) for an unknown camera, light group or view; (cannot_create, io_error, interrupted).
void trace_frames(const Job& job, const PatchSet& scene, const EnergyField& energy, Progress& progress);

}  // namespace patchlight
