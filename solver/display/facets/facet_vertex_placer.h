#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/surface/smooth_normals.h"
#include "solver/display/facets/facet_graph.h"

namespace patchlight {

/// Where a vertex of facets lies, and what it sees.
struct PlacedVertex {
  DisplayMesh::Vertex vertex;
  bool covered = false;  ///< In another body, double-sided as it may be, of which its facet's middle is free.
  float distance = 0;    ///< Harmonic mean distance of what it sees, m.
};

/// Places vertices of facets.
class FacetVertexPlacer {
 public:
  /// `patch_of` [primitives].
  FacetVertexPlacer(const PatchSet& scene, const RayScene& ray_scene, const std::vector<std::int32_t>& patch_of)
      : scene_(scene), ray_scene_(ray_scene), patch_of_(patch_of), normals_(scene) {}

  /// The vertex at the first of some corners, the largest facet's first, that nothing encloses, or else at the most
  /// open one. Adds the number of rays to `rays`.
  PlacedVertex place(std::span<const FacetGraph::Corner> corners, std::uint64_t random, int& rays) const;

 private:
  struct View {
    float openness = 0;  ///< Fraction of rays that go far; negative where most find unlit backs.
    float distance = 0;
  };

  DisplayMesh::Vertex vertex_at(const FacetGraph::Corner& corner, float nudge) const;
  float size_of(std::int32_t primitive) const;
  View view_from(const DisplayMesh::Vertex& vertex, float reach, std::uint64_t random, int& rays) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const std::vector<std::int32_t>& patch_of_;
  const SmoothNormals normals_;
};

}  // namespace patchlight
