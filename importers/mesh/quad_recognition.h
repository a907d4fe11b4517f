#pragma once
#include <vector>

#include "importers/mesh/mesh_topology.h"
#include "importers/mesh/surface.h"

namespace patchlight {

/// Result of recognize_quads.
struct RecognizedFacets {
  std::vector<Facet> facets;
  std::int32_t smooth_vertices = 0;  ///< Upper bound of the facets' smooth vertex numbers.
  std::size_t merged_triangles = 0;  ///< Triangles of coplanar regions that were merged,
  std::size_t merged_facets = 0;     ///< and the facets that replace them.
};

/// Merges coplanar regions into few large quads or, if `as_regions`, planar regions (region_quads), then pairs the
/// remaining coplanar neighbours into convex quads, the most rectangular first. Every other triangle becomes a facet
/// that repeats its last corner; its shortest edge runs from corner 0 to 1. Triangles with texture coordinates or
/// colours are merged only if these are affine over the quad, so that bilinear interpolation between its corners
/// reproduces them, and only if the file's normals agree where they meet. Triangles t with `excluded[t]` are omitted.
/// Facets are in the order of their first triangle.
RecognizedFacets recognize_quads(const MeshTopology& topology, std::vector<char> excluded, bool as_regions);

}  // namespace patchlight
