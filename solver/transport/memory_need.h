#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Bytes that a solve with `rays` a row is going to take at most, within a fifth; of hemicubes within a factor of
/// three, since no one knows yet how many patches they see.
double memory_needed(const PatchSet& scene, const SolveConfig& config, int rays);

/// Bytes that casting one of `shards` shards of the rows is going to take at most.
double shard_memory_needed(const PatchSet& scene, const SolveConfig& config, int shards);

/// The most that it may take, by `config` or as the machine has it, bytes.
double memory_allowed(const SolveConfig& config);

/// Throws: Error (over_limit) for a solve, or one of `shards` shards of its rows, that needs more than it may take.
void check_memory(const PatchSet& scene, const SolveConfig& config, int shards = 0);

}  // namespace patchlight
