#pragma once
#include <vector>

#include "importers/patches/patch_grid.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Cuts the patches of plane primitives along the lines where other surfaces stand on them or cross them, so that no
/// patch lies on both sides of anything, and marks edges of patches along which others stand. Primitives of less than a
/// quarter of the area of their `targets` stay whole, and so do facets of curved meshes and of clusters, and primitives
/// whose emission varies: their patches are sampled as lamps.
void cut_patches(const std::vector<PatchTarget>& targets, PatchSet& scene);

}  // namespace patchlight
