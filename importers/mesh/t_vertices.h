#pragma once
#include <optional>
#include <vector>

#include "importers/mesh/surface.h"

namespace patchlight {

/// A soup in which open edges are split at the vertices of other open edges that run along them, as CAD programs and
/// level editors leave them, so that the triangles on both sides are connected. Values at the new corners are
/// interpolated. A vertex is on an edge within position_tolerance() and a hundredth of the edge's length. `positions`:
/// of the soup's corners, used instead of its own. Empty: there are no such vertices, or more than edges, as in a heap
/// of triangles.
std::optional<TriangleSoup> split_at_t_vertices(const TriangleSoup& soup, const std::vector<Vec3d>& positions);

}  // namespace patchlight
