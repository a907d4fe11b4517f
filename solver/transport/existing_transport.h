#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// The transport.h5 of an earlier solve, if it is intact and of this scene and these settings; else an empty Transport,
/// with a warning where all rays have to be cast again.
Transport read_existing_transport(const Job& job, const PatchSet& scene, Progress& progress);

}  // namespace patchlight
