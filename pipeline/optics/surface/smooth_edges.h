#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Finds the edges of quads that join other quads smoothly.
class SmoothEdges {
 public:
  /// One quad's side of an edge.
  struct Side {
    std::int32_t end;  ///< The larger of the edge's two smooth vertices.
    std::int32_t primitive;
    std::int32_t edge;  ///< 0 to 3 are at v = 0, u = 1, v = 1, u = 0.
  };

  explicit SmoothEdges(const std::vector<Primitive>& primitives);

  bool is_smooth(const Primitive& primitive) const;
  bool is_smooth(const Primitive& primitive, int edge) const { return sides(primitive, edge).size() > 1; }

  /// All sides of a quad's edge, in the order of their primitives; none unless has_sides().
  std::span<const Side> sides(const Primitive& primitive, int edge) const;

  /// Whether an edge of a quad has smooth vertices and a length.
  static bool has_sides(const Primitive& primitive, int edge);

  /// Calls act(sides) for each edge, in the order of its vertices.
  template <class Act>
  void for_each_edge(Act act) const {
    for (std::size_t vertex = 0; vertex < vertices(); ++vertex)
      for (std::uint32_t first = starts_[vertex], end = first; first < starts_[vertex + 1]; first = end) {
        while (end < starts_[vertex + 1] && sides_[end].end == sides_[first].end) ++end;
        act(std::span(sides_).subspan(first, end - first));
      }
  }

  /// One more than the largest number of a smooth vertex.
  std::size_t vertices() const { return starts_.size() - 1; }

 private:
  std::vector<std::uint32_t> starts_;  ///< [vertices + 1] First side of the edges whose smaller vertex it is.
  std::vector<Side> sides_;            ///< By both vertices of their edges.
};

}  // namespace patchlight
