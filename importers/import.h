#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Reads the job's glTF scene, recognises quads and spheres in it and cuts them into patches.
/// The file layer sets `key` and `frames_key`.
/// Throws: Error (missing_input, bad_data, over_limit); (bad_config) for a shader that does not compile or has no value
/// that a surface can have.
PatchSet import_scene(const Job& job, Progress& progress);

}  // namespace patchlight
