#pragma once
#include "pipeline/driver/cache/output_cache.h"
#include "pipeline/driver/stages/stage_account.h"

namespace patchlight {

/// Updates a job's stale stages under Slurm: import; an array of tasks that cast shards of the form factor rows; the
/// solve, which merges the shards; an array of tasks for the frames. The output has the same bits as that of a local
/// run. The caller must hold the output lock. Throws: Error with the exit code of a failed stage; (interrupted);
/// (unavailable) without Slurm.
void run_on_slurm(const RunCommand& command, const Job& job, const OutputCache& cache, StageAccount& account,
                  Progress& progress);

}  // namespace patchlight
