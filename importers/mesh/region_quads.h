#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/coplanar_regions.h"
#include "importers/mesh/surface.h"

namespace patchlight {

/// Cuts a region into few large quads: one where its outline has four corners, else trapezoids between parallel cuts
/// through its corners, rectangles where its edges are at right angles.
/// `most`: more facets are no gain. New corners on straight edges take numbers from `next_smooth` on.
/// Returns nothing for an outline that cannot be cut so, or that is better left as triangles: where a smooth surface
/// needs its vertices, and where trapezoids would be slivers.
std::vector<Facet> region_quads(const MeshTopology& topology, const CoplanarRegion& region, std::size_t most,
                                std::int32_t& next_smooth);

}  // namespace patchlight
