#pragma once
#include <vector>

#include "importers/mesh/surface.h"
#include "importers/patches/facet_clusters.h"
#include "importers/patches/patch_grid.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The patches of all primitives, in the primitives' order; one for each cluster. `materials` by Primitive::material;
/// `targets` by primitive.
std::vector<Patch> build_patches(const std::vector<Primitive>& primitives,
                                 const std::vector<SurfaceMaterial>& materials, const std::vector<PatchTarget>& targets,
                                 const std::vector<FacetCluster>& clusters);

}  // namespace patchlight
