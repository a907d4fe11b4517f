#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Reads the job's glTF scene, recognises quads and spheres and subdivides them into patches.
/// `key` and `frames_key` stay unset; write_patches sets them.
/// Throws: Error (missing_input, bad_data, over_limit); (bad_config) for a shader that does not compile or gives a
/// negative or non-finite value.
PatchSet import_scene(const Job& job, Progress& progress);

}  // namespace patchlight
