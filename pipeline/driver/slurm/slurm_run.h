#pragma once
#include "pipeline/driver/cache/output_cache.h"
#include "pipeline/driver/stages/stage_account.h"

namespace patchlight {

/// Brings a job's stages up to date by Slurm: import, then, each after the other, an array of tasks that cast shards of
/// the rows, the solve that merges them, and an array of tasks for the frames. Results have the same bits as those of a
/// local run. Nobody else may be working in the output folder.
/// Throws: Error with the exit code of a stage that fails, (interrupted), (unavailable) without Slurm.
void run_on_slurm(const RunCommand& command, const Job& job, const OutputCache& cache, StageAccount& account,
                  Progress& progress);

}  // namespace patchlight
