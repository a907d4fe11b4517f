#pragma once
#include "importers/primitive_builder.h"
#include "pipeline/files/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Gives the patches of every primitive with a texture or a shader the means of it over their areas. Reflectance beyond
/// 0.99999, or beyond what a metallic part leaves, is lowered, with a warning for each shader.
/// Throws: Error (bad_config), naming shader, value and (u,v), for what is negative or not finite.
void average_colors(const Job& job, PatchSet& scene, Progress& progress);

/// Multiplies the reflectance of patches by the means of the vertices' colours over their areas. `colors` as
/// PrimitiveList has them.
void apply_vertex_colors(const std::vector<CornerColors>& colors, PatchSet& scene);

}  // namespace patchlight
