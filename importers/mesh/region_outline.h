#pragma once
#include <vector>

#include "importers/mesh/coplanar_regions.h"

namespace patchlight {

/// A region's boundary without the vertices on its straight edges, in the plane.
struct RegionOutline {
  std::vector<CoplanarRegion::Corner> corners;
  std::vector<Imath::V2d> points;  ///< The corners in the plane, m.
  std::vector<std::size_t> next;   ///< The corner that each is followed by, the region to its left.
  bool needs_vertices = false;     ///< Some corners stand on straight edges, since a smooth surface needs them.
};

/// Empty where a region has no loops, or more vertices on them than can be looked at.
RegionOutline outline_of(const MeshTopology& topology, const CoplanarRegion& region);

}  // namespace patchlight
