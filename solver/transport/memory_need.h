#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Upper bound of the memory of a solve with `rays` rays a row, bytes, within 20%; for hemicubes within a factor of 3,
/// since the number of visible patches is unknown, and with an environment within a factor of 2.
double memory_needed(const PatchSet& scene, const SolveConfig& config, int rays);

/// Upper bound of the memory for casting one of `shards` shards of the rows, bytes.
double shard_memory_needed(const PatchSet& scene, const SolveConfig& config, int shards);

/// The memory limit of `config`, or else the machine's memory, bytes.
double memory_allowed(const SolveConfig& config);

/// Throws: Error (over_limit) if a solve, or one of `shards` shards of its rows, needs more memory than allowed.
void check_memory(const PatchSet& scene, const SolveConfig& config, int shards = 0);

}  // namespace patchlight
