#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/model/shard.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Renders every frame of the job into its folder of frames, as EXR and PNG, or of K shards the k-th every K-th from
/// the k-th on; with `skip_fresh` only those that are not there yet as the job makes them now, sharing them with other
/// processes that do the same.
/// Throws: Error (bad_config) for an unknown camera, light group or view; (cannot_create, io_error, interrupted).
void trace_frames(const Job& job, const PatchSet& scene, const EnergyField& energy, bool skip_fresh, Shard shard,
                  Progress& progress);

}  // namespace patchlight
