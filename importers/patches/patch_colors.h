#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Averages reflectance and emission over the patches of primitives with a texture, vertex colours, a mask or a shader.
/// Only the part that passes the alpha test counts; Patch::coverage is its fraction, at least 1/1024.
/// Shader reflectance above 0.99999, or above 1 minus the specular reflectance, is lowered, with a warning per shader.
/// Throws: Error (bad_config) for a negative or non-finite shader value, naming shader, value and (u,v).
void average_colors(const Job& job, PatchSet& scene, Progress& progress);

/// Sets what the coats of patches let through, on average over all directions.
void average_coats(PatchSet& scene);

}  // namespace patchlight
