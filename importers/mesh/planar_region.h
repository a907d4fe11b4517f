#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "importers/mesh/coplanar_regions.h"
#include "importers/mesh/region_outline.h"
#include "importers/mesh/surface.h"

namespace patchlight {

/// A coplanar region as one facet: the rectangle around it, along the direction in which most of its outline runs, and
/// what there is of that. Its values are the affine continuation of the largest triangle's. `outline`: empty if its
/// boundary touches itself. `pieces`: convex quads that tile it, if they are known; otherwise its triangles do.
/// `next_smooth`: the next smooth vertex, advanced.
Facet planar_region(const MeshTopology& topology, const CoplanarRegion& region, const RegionOutline& outline,
                    const std::vector<std::array<Vec3d, 4>>& pieces, std::int32_t& next_smooth);

}  // namespace patchlight
