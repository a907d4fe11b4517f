#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Quadtrees that subdivide patches on which irradiance varies too fast for one value, near contacts and creases, with
/// irradiance at the leaves' corners (patches and elements: Cohen, Greenberg, Immel and Brock 1986).
struct DisplayMesh {
  struct Cell {
    std::int32_t children = -1;  ///< First of four children, in rows of growing u; -1: a leaf.
    std::int32_t leaf = -1;      ///< A leaf's first element; -1: not a leaf.
    bool cut = false;  ///< A leaf whose corners are occluded from each other, or covered: one element per corner.
    std::array<std::int32_t, 4> corners{-1, -1, -1, -1};  ///< A leaf's vertices, in rows of growing u.

    int elements() const { return children >= 0 ? 0 : cut ? 4 : 1; }
  };
  struct Vertex {
    std::int32_t patch = 0;  ///< One of the patches that share the vertex.
    float u = 0, v = 0;      ///< Position on the patch's primitive.
    bool hidden = false;     ///< Covered by another surface: its irradiance is invalid elsewhere.
  };

  /// A facet of a curved mesh: a single patch with gathered irradiance at some of its corners.
  struct Facet {
    std::int32_t patch = 0;
    std::array<std::int32_t, 4> corners{-1, -1, -1,
                                        -1};  ///< Vertices, in rows of growing u; -1: interpolated from patches.
  };

  std::vector<std::int32_t> roots;  ///< [patches]: root cell of each patch; -1: not subdivided.
  std::vector<Cell> cells;          ///< Parents before their children.
  std::vector<Facet> facets;        ///< On patches without a root cell.
  std::int32_t elements = 0;        ///< Number of elements: one per leaf, four per cut leaf.

  /// In this order: vertices with gathered irradiance; vertices interpolated from patches, where they border on patches
  /// that are not subdivided; hanging vertices, the midpoints of two earlier vertices, where they border on a larger
  /// leaf.
  std::vector<Vertex> vertices;
  std::int32_t gathered = 0;                             ///< Number of vertices with gathered irradiance.
  std::vector<std::array<std::int32_t, 2>> midpoints{};  ///< The two vertices of each hanging vertex.

  /// A leaf, and a position in it.
  struct Place {
    const Cell* leaf = nullptr;
    float u = 0, v = 0;  ///< In [0,1].
  };

  /// The leaf at (u,v) of a patch's primitive. The patch must have a root cell.
  Place find(std::int32_t index, const Patch& patch, float u, float v) const {
    const auto relative_position = [](float x, float low, float high) {
      const float t = (x - low) / (high - low);
      return t < 0.0f ? 0.0f : (t > 1.0f ? 1.0f : t);
    };
    Place at{&cells[roots[index]], relative_position(u, patch.u0, patch.u1), relative_position(v, patch.v0, patch.v1)};
    while (at.leaf->children >= 0) {
      const int right = at.u >= 0.5f, upper = at.v >= 0.5f;
      at = {&cells[at.leaf->children + 2 * upper + right], 2 * at.u - float(right), 2 * at.v - float(upper)};
    }
    return at;
  }
};

}  // namespace patchlight
