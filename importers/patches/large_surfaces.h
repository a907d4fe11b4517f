#pragma once
#include <vector>

#include "importers/mesh/surface.h"
#include "importers/patches/patch_grid.h"
#include "importers/patches/primitive_builder.h"

namespace patchlight {

/// Divides plane surfaces beside which much smaller things stand into quads, each with patches of the size that the
/// things near it ask for (SizeField): a ground of kilometres has small patches around a house. Sizes are halves,
/// quarters, eighths and so on of the surface's own. What emits light, metals and facets of curved meshes stay whole,
/// and so do surfaces whose patch area the job sets. If that adds more than kDefaultPatches times import.accuracy, or
/// exceeds import.max_patches, all of it is coarser. With import.patch_area nothing is divided.
/// `patch_areas`: targets of the primitives before, m2. Returns those of the primitives afterwards.
std::vector<PatchTarget> divide_large_surfaces(const std::vector<SurfaceMaterial>& materials,
                                               const std::vector<double>& patch_areas, const ImportConfig& config,
                                               PrimitiveList& list);

}  // namespace patchlight
