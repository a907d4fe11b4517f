#pragma once
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Parts of a solve. `shots`, of progressive refinement, takes the place of the first three.
enum class SolvePart { rows, direct_light, linear_system, shots, display_rows, display_light };

/// Progress now reports this part of a whole solve.
void begin_part(SolvePart part, const SolveConfig& config, Progress& progress);

}  // namespace patchlight
