#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/coplanar_regions.h"
#include "importers/mesh/surface.h"

namespace patchlight {

/// Replaces a region's triangles: by a single quad if its outline has four corners; by the rectangles between parallel
/// lines through its corners if all its edges are at right angles; else, if `as_regions` and there are no vertex
/// colours, by one planar_region, otherwise by trapezoids between such lines.
/// New corners on straight edges get smooth vertex numbers from `next_smooth` on.
/// Returns nothing if the outline allows no such decomposition, if more than `max_facets` facets result, if a smooth
/// neighbour requires the vertices, or if the trapezoids are slivers.
std::vector<Facet> region_quads(const MeshTopology& topology, const CoplanarRegion& region, std::size_t max_facets,
                                bool as_regions, std::int32_t& next_smooth);

}  // namespace patchlight
