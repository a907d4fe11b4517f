#include "pipeline/optics/surface/smooth_edges.h"

#include <algorithm>
#include <array>

namespace patchlight {

namespace {

std::uint64_t edge_key(const Primitive& p, int edge) {
  constexpr std::array<std::array<int, 2>, 4> kEnds{{{0, 1}, {1, 2}, {3, 2}, {0, 3}}};
  const std::int32_t a = p.smooth_vertices[kEnds[edge][0]], b = p.smooth_vertices[kEnds[edge][1]];
  if (a < 0 || b < 0 || a == b) return 0;
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

}  // namespace

SmoothEdges::SmoothEdges(const std::vector<Primitive>& primitives) {
  count_.reserve(2 * primitives.size());
  for (const Primitive& p : primitives)
    for (int edge = 0; edge < 4 && p.shape == Primitive::Shape::quad; ++edge)
      if (const std::uint64_t key = edge_key(p, edge)) ++count_[key];
}

bool SmoothEdges::is_smooth(const Primitive& primitive, int edge) const {
  const std::uint64_t key = edge_key(primitive, edge);
  return key != 0 && count_.at(key) > 1;
}

bool SmoothEdges::is_smooth(const Primitive& primitive) const {
  if (primitive.shape == Primitive::Shape::sphere) return false;
  return is_smooth(primitive, 0) || is_smooth(primitive, 1) || is_smooth(primitive, 2) || is_smooth(primitive, 3);
}

}  // namespace patchlight
