#pragma once
#include <vector>

#include "importers/mesh_topology.h"
#include "importers/surface.h"

namespace patchlight {

/// Pairs coplanar triangles that share an edge into convex quads, the most rectangular first; every other triangle
/// becomes a facet that repeats its last corner, its shortest edge from corner 0 to 1.
/// Where there are texture coordinates or colours, a pair becomes a quad only if one affine map gives all its corners
/// theirs, so that the quad's bilinear mean of them is what the triangles have.
/// `taken[t]` leaves out triangle t. Facets stand in the order of their first triangle.
std::vector<Facet> recognize_quads(const MeshTopology& topology, const std::vector<char>& taken);

}  // namespace patchlight
