#include "importers/mesh/open_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "importers/mesh/vertex_welding.h"

namespace patchlight {
namespace {

constexpr double kFloatTolerance = 64.0, kQuantizedTolerance = 2.0;  // in rounding errors
constexpr double kOfEdge = 0.01;                                     // of the shortest edge at a vertex
constexpr int kMostNear = 256;  // vertices that one is compared with; a heap of loose triangles has more

/// A vertex at an open edge.
struct OpenVertex {
  Vec3d position{0.0};
  std::int32_t weld = 0;
  double shortest = std::numeric_limits<double>::infinity();  ///< Length of the edges at it, m.
};

/// The vertices at open edges. `weld`: numbers of corners.
std::vector<OpenVertex> open_vertices(const TriangleSoup& soup, const std::vector<std::int32_t>& weld) {
  std::vector<double> shortest(weld.size(), std::numeric_limits<double>::infinity());
  for (std::size_t corner = 0; corner < weld.size(); ++corner) {
    const std::size_t next = next_corner(corner);
    if (weld[corner] == weld[next]) continue;
    const double length = (soup.positions[next] - soup.positions[corner]).length();
    for (const std::size_t k : {corner, next}) shortest[weld[k]] = std::min(shortest[weld[k]], length);
  }
  std::vector<char> is_open(weld.size(), 0);
  for (const std::int32_t corner : open_edges(weld))
    is_open[weld[corner]] = is_open[weld[next_corner(std::size_t(corner))]] = 1;
  std::vector<OpenVertex> vertices;
  for (std::size_t corner = 0; corner < weld.size(); ++corner) {
    char& open = is_open[weld[corner]];
    if (open == 1) vertices.push_back({soup.positions[corner], weld[corner], shortest[weld[corner]]});
    open = 0;
  }
  return vertices;
}

/// Calls act(a, b) for two vertices in the same or neighbouring cells of a grid, for at most kMostNear with each a.
template <class Act>
void for_each_near_pair(const std::vector<OpenVertex>& vertices, double cell_size, const Act& act) {
  using Cell = std::array<std::int64_t, 3>;
  struct Entry {
    Cell cell;
    std::size_t vertex;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> entries;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<std::int64_t>(std::floor(vertices[k].position[axis] / cell_size));
    entries.push_back({cell, k});
  }
  std::sort(entries.begin(), entries.end());
  const auto cell_of = [](const Entry& entry) -> const Cell& { return entry.cell; };
  for (const Entry& entry : entries) {
    int count = 0;
    for (int offset = 0; offset < 27; ++offset) {
      const Cell cell{entry.cell[0] + offset % 3 - 1, entry.cell[1] + offset / 3 % 3 - 1,
                      entry.cell[2] + offset / 9 - 1};
      for (const Entry& near : std::ranges::equal_range(entries, cell, {}, cell_of)) {
        if (++count > kMostNear) break;
        if (near.vertex > entry.vertex) act(entry.vertex, near.vertex);
      }
    }
  }
}

}  // namespace

std::vector<std::int32_t> open_edges(const std::vector<std::int32_t>& weld) {
  struct Edge {
    std::int32_t low, high, corner;
    bool joins_same(const Edge& other) const { return low == other.low && high == other.high; }
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  edges.reserve(weld.size());
  for (std::size_t corner = 0; corner < weld.size(); ++corner) {
    const std::int32_t from = weld[corner], to = weld[next_corner(corner)];
    if (from != to) edges.push_back({std::min(from, to), std::max(from, to), std::int32_t(corner)});
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::int32_t> open;
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    while (end < edges.size() && edges[end].joins_same(edges[first])) ++end;
    if (end - first == 1) open.push_back(edges[first].corner);
  }
  return open;
}

double position_tolerance(const TriangleSoup& soup) {
  return soup.rounding * (soup.quantized ? kQuantizedTolerance : kFloatTolerance);
}

std::vector<Vec3d> with_closed_seams(const TriangleSoup& soup) {
  std::vector<Vec3d> positions = soup.positions;
  const double tolerance = position_tolerance(soup);
  if (!(tolerance > 0.0)) return positions;
  const std::vector<std::int32_t> weld = weld_corners(soup.positions);
  const std::vector<OpenVertex> vertices = open_vertices(soup, weld);
  DisjointSets sets(vertices.size());
  double largest = 0.0;
  for (const OpenVertex& vertex : vertices) largest = std::max(largest, std::min(tolerance, kOfEdge * vertex.shortest));
  if (!(largest > 0.0)) return positions;
  for_each_near_pair(vertices, largest, [&](std::size_t a, std::size_t b) {
    const double limit = std::min(tolerance, kOfEdge * std::min(vertices[a].shortest, vertices[b].shortest));
    if ((vertices[a].position - vertices[b].position).length() <= limit)
      sets.join(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b));
  });
  std::vector<std::int32_t> open_vertex(weld.size(), -1);  // by weld number
  for (std::size_t k = 0; k < vertices.size(); ++k)
    open_vertex[vertices[k].weld] = sets.find(static_cast<std::int32_t>(k));
  for (std::size_t corner = 0; corner < weld.size(); ++corner)
    if (const std::int32_t k = open_vertex[weld[corner]]; k >= 0) positions[corner] = vertices[k].position;
  return positions;
}

}  // namespace patchlight
