#include "pipeline/optics/surface/smooth_edges.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

namespace patchlight {

namespace {

/// The smaller and the larger smooth vertex of an edge; -1 and -1: it has none, or no length.
std::pair<std::int32_t, std::int32_t> ends_of(const Primitive& p, int edge) {
  constexpr std::array<std::array<int, 2>, 4> kEnds{{{0, 1}, {1, 2}, {3, 2}, {0, 3}}};
  const std::int32_t a = p.smooth_vertices[kEnds[edge][0]], b = p.smooth_vertices[kEnds[edge][1]];
  if (p.shape != Primitive::Shape::quad || a < 0 || b < 0 || a == b) return {-1, -1};
  return std::minmax(a, b);
}

}  // namespace

SmoothEdges::SmoothEdges(const std::vector<Primitive>& primitives) : starts_(1) {
  const auto for_each_side = [&](std::size_t i, auto act) {
    for (int edge = 0; edge < 4; ++edge)
      if (const auto [low, high] = ends_of(primitives[i], edge); low >= 0)
        act(std::size_t(low), Side{high, std::int32_t(i), edge});
  };
  starts_.reserve(4 * primitives.size() + 1);
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    for (const std::int32_t id : primitives[i].smooth_vertices)
      if (id >= std::int32_t(vertices())) starts_.resize(std::size_t(id) + 2);
    for_each_side(i, [&](std::size_t low, const Side&) { ++starts_[low]; });
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& start : starts_) start = sum += start;
  sides_.resize(sum);
  for (std::size_t i = 0; i < primitives.size(); ++i)
    for_each_side(i, [&](std::size_t low, const Side& side) { sides_[--starts_[low]] = side; });
  const auto order = [](const Side& side) { return std::tie(side.end, side.primitive, side.edge); };
  for (std::size_t vertex = 0; vertex < vertices(); ++vertex)
    std::sort(sides_.begin() + starts_[vertex], sides_.begin() + starts_[vertex + 1],
              [&](const Side& a, const Side& b) { return order(a) < order(b); });
}

std::span<const SmoothEdges::Side> SmoothEdges::sides(const Primitive& primitive, int edge) const {
  const auto [low, high] = ends_of(primitive, edge);
  if (low < 0) return {};
  const std::span of_vertex = std::span(sides_).subspan(starts_[low], starts_[low + 1] - starts_[low]);
  const auto [first, last] = std::ranges::equal_range(of_vertex, high, {}, &Side::end);
  return {first, last};
}

bool SmoothEdges::has_sides(const Primitive& primitive, int edge) {
  return ends_of(primitive, edge).first >= 0;
}

bool SmoothEdges::is_smooth(const Primitive& primitive) const {
  return is_smooth(primitive, 0) || is_smooth(primitive, 1) || is_smooth(primitive, 2) || is_smooth(primitive, 3);
}

}  // namespace patchlight
