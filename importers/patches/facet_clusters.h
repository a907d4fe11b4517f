#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/surface.h"
#include "importers/patches/patch_grid.h"
#include "importers/patches/primitive_builder.h"

namespace patchlight {

/// Facets that are one patch: consecutive primitives.
struct FacetCluster {
  std::int32_t first = 0, count = 0;
};

/// Groups the facets of meshes that are smaller than half of their target into clusters of about the target area (face
/// clusters: Willmott, Heckbert and Garland 1999), however finely the mesh is divided. A body is divided along its
/// longest direction until its parts are small enough, and where the part is not small, by its normals until they
/// differ by less than about 45 degrees. Parts are connected. Boxes and other bodies of less than 24 facets are in
/// none, nor are lamps, metals, masks, regions and spheres.
///
/// Brings the primitives of a cluster together, and their `targets` too; both sides of a facet are of clusters of the
/// same facets. Returns the clusters in the order of their primitives.
std::vector<FacetCluster> cluster_facets(const std::vector<SurfaceMaterial>& materials,
                                         std::vector<PatchTarget>& targets, PrimitiveList& list);

}  // namespace patchlight
