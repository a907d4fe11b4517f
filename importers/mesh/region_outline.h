#pragma once
#include <vector>

#include "importers/mesh/coplanar_regions.h"

namespace patchlight {

/// A region's boundary loops in 2D, without vertices inside straight edges.
struct RegionOutline {
  std::vector<CoplanarRegion::Corner> corners;
  std::vector<Imath::V2d> points;  ///< Positions of the corners in the plane, m.
  std::vector<std::size_t> next;   ///< Index of the next corner on the loop; the region lies to the left.
};

/// Empty if the region has no loops, or a loop of too many vertices.
RegionOutline outline_of(const MeshTopology& topology, const CoplanarRegion& region);

}  // namespace patchlight
