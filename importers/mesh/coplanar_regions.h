#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/mesh_topology.h"

namespace patchlight {

/// Connected triangles in one plane whose normals, texture coordinates and colours are affine functions of position.
struct CoplanarRegion {
  /// A boundary vertex, as a corner of one of the region's triangles.
  struct Corner {
    std::int32_t vertex = 0;
    std::int32_t triangle = 0;
    int index = 0;          ///< Corner of the triangle, 0 to 2.
    bool required = false;  ///< A smooth surface bends here and shares this vertex, so it must not be removed.

    /// Index into arrays over the corners of all triangles.
    std::int32_t corner_index() const { return 3 * triangle + index; }
  };

  std::vector<std::int32_t> triangles;  ///< In ascending order.
  std::vector<std::vector<Corner>>
      loops;               ///< Boundary, counter-clockwise; holes clockwise. Empty if the boundary touches itself.
  bool bends = false;      ///< A smooth surface bends at its boundary.
  Vec3d normal{0.0};       ///< Unit.
  double tolerance = 0.0;  ///< m; distance of vertices from the plane, and from a straight edge.
};

/// The regions of at least three triangles. Triangles t with `excluded[t]` belong to none.
std::vector<CoplanarRegion> find_coplanar_regions(const MeshTopology& topology, const std::vector<char>& excluded);

}  // namespace patchlight
