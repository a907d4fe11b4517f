#pragma once
#include "pipeline/job/job.h"
#include "pipeline/job/shard.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Casts one task's part of the rows of a job's transport, of patches and of vertices of the display mesh, bit for bit
/// as a single solve casts them. The scene must have emitters. Throws: Error (interrupted), (over_limit).
TransportShard cast_transport_shard(const PatchSet& scene, const SolveConfig& config, Shard shard, Progress& progress);

/// Merges the rows of the `count` shards in a job's output; emitters must still be sampled. Adds the number of the
/// shards' rays to `cast`. Throws: Error (missing_input) for a missing shard, (bad_data) for one that is damaged or was
/// cast for another scene or other settings, with the command to cast it.
Transport merge_transport_shards(const Job& job, const PatchSet& scene, int count, std::int64_t& cast,
                                 Progress& progress);

}  // namespace patchlight
