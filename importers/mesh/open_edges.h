#pragma once
#include <vector>

#include "importers/mesh/surface.h"

namespace patchlight {

/// The positions of a soup's corners, where vertices of open edges that differ by less than the file's precision get
/// the same position. Such vertices are at the seams and poles of generated spheres, and in files with rounded
/// coordinates. An edge is open if a single triangle has it.
///
/// The precision of floats is 64 times the rounding error of the mesh's largest coordinate, 4e-6 of that coordinate; of
/// quantized positions, twice their rounding error. It is at most a hundredth of the shortest edge at the two vertices.
/// Shape: [3 triangles].
std::vector<Vec3d> with_closed_seams(const TriangleSoup& soup);

}  // namespace patchlight
