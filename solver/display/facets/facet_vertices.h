#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "solver/display/facets/facet_graph.h"

namespace patchlight {

/// Vertices at some nodes of a graph, and blends of them at the others.
struct FacetVertices {
  static constexpr std::int32_t kNone = -1;

  std::vector<DisplayMesh::Vertex> vertices;
  /// [nodes] Its vertex; from the number of vertices on, its blend; kNone: enclosed in another body.
  std::vector<std::int32_t> of_node;
  std::vector<DisplayMesh::Blend> blends{};
  std::vector<DisplayMesh::Part> blended{};
};

/// Chooses vertices as an irradiance cache does (Ward, Rubinstein and Clear 1988): each serves the nodes around it
/// along the facets, as far as half of the harmonic mean distance of what it sees, and as far as normals differ by less
/// than 45 degrees. So their number follows from the light, not from the number of facets. `patch_of` [primitives].
/// Adds the number of rays to `cast`.
FacetVertices choose_facet_vertices(const PatchSet& scene, const RayScene& ray_scene, const FacetGraph& graph,
                                    const std::vector<std::int32_t>& patch_of, std::int64_t& cast);

}  // namespace patchlight
