#pragma once
#include "pipeline/job/job.h"

namespace patchlight {

/// Throws: Error (bad_config) for combinations of `solve` settings that no solver supports.
void check_available(const SolveConfig& solve);

/// Whether rows of form factors can be computed by several tasks.
bool is_shardable(const SolveConfig& solve);

/// Throws: Error (bad_config) if they cannot.
void check_shardable(const Job& job);

}  // namespace patchlight
