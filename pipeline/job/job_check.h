#pragma once
#include "pipeline/job/job.h"

namespace patchlight {

/// Throws: Error (bad_config) for settings of `solve` that no solver can follow yet.
void check_available(const SolveConfig& solve);

/// Whether rows of form factors can be cast by several tasks.
bool is_shardable(const SolveConfig& solve);

/// Throws: Error (bad_config) where they cannot.
void check_shardable(const Job& job);

}  // namespace patchlight
