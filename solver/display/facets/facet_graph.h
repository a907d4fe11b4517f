#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Facets of meshes, their corners, and the ways between these along the facets.
struct FacetGraph {
  /// A facet's corner.
  struct Corner {
    std::int32_t primitive = 0;
    int k = 0;  ///< In rows of growing u.
  };

  /// Corners at one place without a crease between them.
  struct Node {
    Vec3d position{0.0};  ///< m
    Vec3f normal{0.0f};   ///< Mean shading normal of its corners. Unit vector.
    float scale = 0;      ///< Root of the target of patches there, m.
  };

  struct Way {
    std::int32_t to = 0;
    float length = 0;  ///< m; 0 across a crease.
  };

  std::vector<Node> nodes;
  std::vector<std::int32_t> node_of;                   ///< [smooth vertices, or fewer]; -1: none.
  std::vector<std::size_t> corner_starts, way_starts;  ///< [nodes + 1] Into `corners` and `ways`.
  std::vector<Corner> corners;
  std::vector<Way> ways;

  std::span<const Corner> corners_of(std::int32_t node) const {
    return std::span(corners).subspan(corner_starts[node], corner_starts[node + 1] - corner_starts[node]);
  }
  std::span<const Way> ways_from(std::int32_t node) const {
    return std::span(ways).subspan(way_starts[node], way_starts[node + 1] - way_starts[node]);
  }
  std::int32_t at(std::int32_t smooth_vertex) const {
    return std::size_t(smooth_vertex) < node_of.size() ? node_of[smooth_vertex] : -1;
  }
};

/// Corners of a primitive in rows of growing u.
inline constexpr std::array<int, 4> kCornersInRows{0, 1, 3, 2};

/// The graph of some facets, which are primitives with smooth vertices.
FacetGraph facet_graph(const PatchSet& scene, std::span<const std::int32_t> facets);

}  // namespace patchlight
