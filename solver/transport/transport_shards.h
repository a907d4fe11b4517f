#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/shard.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Casts one task's part of the rows of a job's transport, of patches and of vertices of the display mesh, with the
/// same bits as they get where one solve casts all. Of a scene with emitters.
/// Throws: Error (interrupted), (over_limit).
TransportShard cast_transport_shard(const PatchSet& scene, const SolveConfig& config, Shard shard, Progress& progress);

/// Puts the rows of `count` shards in a job's output together; emitters are still to be sampled. Adds to `cast` how
/// many rays the shards took. Throws: Error (missing_input) for one that is not there, (bad_data) for one that is
/// damaged or was cast for something else, naming it and how to cast it.
Transport merge_transport_shards(const Job& job, const PatchSet& scene, int count, std::int64_t& cast,
                                 Progress& progress);

}  // namespace patchlight
