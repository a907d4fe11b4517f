#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Gives the patches of every primitive with a texture, vertices' colours, a mask or a shader the means over that part
/// of their areas which is there, and how large a part that is: no less than 1/1024. Reflectance beyond 0.99999, or
/// beyond what a metallic part leaves, is lowered, with a warning for each shader. Throws: Error (bad_config), naming
/// shader, value and (u,v), for what is negative or not finite.
void average_colors(const Job& job, PatchSet& scene, Progress& progress);

}  // namespace patchlight
