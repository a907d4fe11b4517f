#pragma once
#include <vector>

#include "importers/mesh/mesh_topology.h"
#include "importers/mesh/surface.h"

namespace patchlight {

/// What recognize_quads makes of a mesh.
struct RecognizedFacets {
  std::vector<Facet> facets;
  std::int32_t smooth_vertices = 0;  ///< Their numbers are below this.
  std::size_t merged_triangles = 0;  ///< Of coplanar regions that became fewer facets than pairs would be,
  std::size_t merged_facets = 0;     ///< and those.
};

/// Merges coplanar regions of triangles into few large quads (region_quads), and pairs the coplanar triangles that are
/// left and share an edge into convex quads, the most rectangular first; every other triangle becomes a facet that
/// repeats its last corner, its shortest edge from corner 0 to 1.
/// Where there are texture coordinates or colours, triangles become a quad only if one affine map gives all its corners
/// theirs, so that the quad's bilinear mean of them is what the triangles have.
/// `taken[t]` leaves out triangle t. Facets stand in the order of their first triangle.
RecognizedFacets recognize_quads(const MeshTopology& topology, std::vector<char> taken);

}  // namespace patchlight
