#pragma once
#include "pipeline/job/job.h"
#include "pipeline/job/shard.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Renders the job's frames into its frame folder as EXR and PNG. Shard k of K renders frames k, k + K, k + 2K, ...
/// `skip_fresh`: leaves out frames that are up to date and shares the others with processes that do the same.
/// Throws: Error (bad_config) for an unknown camera, light group or view; (cannot_create, io_error, interrupted).
void trace_frames(const Job& job, const PatchSet& scene, const EnergyField& energy, bool skip_fresh, Shard shard,
                  Progress& progress);

}  // namespace patchlight
