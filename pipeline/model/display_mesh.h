#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Quadtrees in place of patches that irradiance varies too fast on for one value each, near contacts and creases, with
/// irradiance at the leaves' corners (patches and elements: Cohen, Greenberg, Immel and Brock 1986).
struct DisplayMesh {
  struct Cell {
    std::int32_t children = -1;  ///< First of four, in rows of growing u; -1: a leaf.
    std::int32_t leaf = -1;      ///< Its number among the leaves' elements; -1: not a leaf.
    bool cut = false;  ///< Something stands between a leaf's corners, or hides some: each is an element of its own.
    std::array<std::int32_t, 4> corners{-1, -1, -1, -1};  ///< Vertices of a leaf, in rows of growing u.

    int elements() const { return children >= 0 ? 0 : cut ? 4 : 1; }
  };
  struct Vertex {
    std::int32_t patch = 0;  ///< One of those that it belongs to.
    float u = 0, v = 0;      ///< On the patch's primitive.
    bool hidden = false;     ///< What it says holds for covered places only: of no use for others.
  };

  /// A facet of a curved mesh, a patch by itself, some of whose corners have irradiance of their own.
  struct Facet {
    std::int32_t patch = 0;
    std::array<std::int32_t, 4> corners{-1, -1, -1, -1};  ///< Vertices, in rows of growing u; -1: as patches say.
  };

  std::vector<std::int32_t> roots;  ///< [patches]: the cell that stands for a patch; -1: none.
  std::vector<Cell> cells;          ///< Children behind their parents.
  std::vector<Facet> facets;        ///< Of patches that no cell stands for.
  std::int32_t elements = 0;        ///< Of leaves: one each, four of those that are cut.

  /// First those that have irradiance of their own, then those that take what patches say, since they border on patches
  /// that are whole, and last those that are halfway between two before them, since they border on a larger leaf.
  std::vector<Vertex> vertices;
  std::int32_t gathered = 0;                             ///< How many of the first kind.
  std::vector<std::array<std::int32_t, 2>> midpoints{};  ///< Of the last kind: the two.

  /// A leaf, and the place in it.
  struct Place {
    const Cell* leaf = nullptr;
    float u = 0, v = 0;  ///< In [0,1].
  };

  /// The leaf at (u,v) of a patch's primitive, for a patch that has one.
  Place find(std::int32_t index, const Patch& patch, float u, float v) const {
    const auto within = [](float x, float low, float high) {
      const float t = (x - low) / (high - low);
      return t < 0.0f ? 0.0f : (t > 1.0f ? 1.0f : t);
    };
    Place at{&cells[roots[index]], within(u, patch.u0, patch.u1), within(v, patch.v0, patch.v1)};
    while (at.leaf->children >= 0) {
      const int right = at.u >= 0.5f, upper = at.v >= 0.5f;
      at = {&cells[at.leaf->children + 2 * upper + right], 2 * at.u - float(right), 2 * at.v - float(upper)};
    }
    return at;
  }
};

}  // namespace patchlight
