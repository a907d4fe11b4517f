#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/mesh_topology.h"

namespace patchlight {

/// Triangles that lie in one plane, connected through edges, whose texture coordinates and colours are one affine map.
struct CoplanarRegion {
  /// A vertex of the boundary, as a corner of one of the region's triangles.
  struct Corner {
    std::int32_t vertex = 0;
    std::int32_t triangle = 0;
    int index = 0;
    bool kept = false;  ///< A smooth surface bends away from here: it needs this vertex.

    std::int32_t number() const { return 3 * triangle + index; }
  };

  std::vector<std::int32_t> triangles;     ///< Growing numbers.
  std::vector<std::vector<Corner>> loops;  ///< Boundary, the region to its left. Empty where it touches itself.
  Vec3d normal{0.0};                       ///< Unit.
  double tolerance = 0.0;                  ///< m; how far vertices may lie from the plane, and from a straight edge.
};

/// The regions of three triangles and more. `taken[t]` leaves out triangle t.
std::vector<CoplanarRegion> find_coplanar_regions(const MeshTopology& topology, const std::vector<char>& taken);

}  // namespace patchlight
