#pragma once
#include <vector>

#include "importers/mesh/surface.h"

namespace patchlight {

/// The edges of a soup that a single triangle uses, each by the corner that it starts at. `weld`: numbers of corners.
std::vector<std::int32_t> open_edges(const std::vector<std::int32_t>& weld);

/// The distance, m, up to which positions of a soup are the same in its file: 64 times the rounding error of the mesh's
/// largest coordinate if they are floats, twice their rounding error if they are quantized.
double position_tolerance(const TriangleSoup& soup);

/// The positions of a soup's corners, where vertices of open edges that differ by less than the file's precision get
/// the same position. Such vertices are at the seams and poles of generated spheres, and in files with rounded
/// coordinates. The precision is position_tolerance(), and at most a hundredth of the shortest edge at the two
/// vertices. Shape: [3 triangles].
std::vector<Vec3d> with_closed_seams(const TriangleSoup& soup);

}  // namespace patchlight
