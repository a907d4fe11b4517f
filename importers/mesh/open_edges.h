#pragma once
#include <vector>

#include "importers/mesh/surface.h"

namespace patchlight {

/// The positions of a soup's corners, in which vertices at open edges of the mesh that are the same within the file's
/// precision are one: as generators leave them at the seam and the poles of a sphere, and files with rounded numbers.
///
/// The precision is 64 rounding errors of the largest coordinate of a float, which is 4e-6 of it, or twice that of a
/// quantized position; at most a hundredth of the shortest edge at the vertices. Edges are open if just one triangle
/// uses them. Shape: [3 triangles].
std::vector<Vec3d> with_closed_seams(const TriangleSoup& soup);

}  // namespace patchlight
