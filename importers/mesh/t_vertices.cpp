#include "importers/mesh/t_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "importers/mesh/open_edges.h"
#include "importers/mesh/vertex_welding.h"

namespace patchlight {
namespace {

constexpr double kOfSplitEdge = 0.01;  // distance of a vertex, over the edge's length
constexpr int kMostEnds = 1024;        // vertices that an edge is compared with; a heap of loose triangles has more

/// An open edge of a triangle, from the vertex of its corner to the vertex of the next.
struct Edge {
  std::int32_t corner = 0;
  Vec3d from{0.0}, to{0.0};

  Vec3d direction() const { return (to - from).normalized(); }
  double length() const { return (to - from).length(); }
  double along(const Vec3d& point) const { return (point - from).dot(direction()); }
  double distance(const Vec3d& point) const { return ((point - from) % direction()).length(); }
};

/// The ends of open edges: a k-d tree in place.
class EndTree {
 public:
  struct End {
    Vec3d position{0.0};
    std::int32_t edge = 0;
  };

  explicit EndTree(const std::vector<Edge>& edges) {
    for (std::size_t k = 0; k < edges.size(); ++k)
      for (const Vec3d& position : {edges[k].from, edges[k].to}) ends_.push_back({position, std::int32_t(k)});
    build(0, ends_.size(), 0);
  }

  /// Calls act(end) for all ends within a distance of an edge, and for some others. Returns false if there are more
  /// than kMostEnds.
  template <class Act>
  bool for_each_near(const Edge& edge, double tolerance, const Act& act) const {
    int visits = 0;
    visit({0, ends_.size(), 0, 0.0, 1.0}, edge, tolerance, visits, act);
    return visits <= kMostEnds;
  }

 private:
  void build(std::size_t first, std::size_t last, int axis) {
    if (last - first < 2) return;
    const std::size_t middle = (first + last) / 2;
    const auto at = [&](std::size_t k) { return ends_.begin() + std::ptrdiff_t(k); };
    std::nth_element(at(first), at(middle), at(last),
                     [&](const End& a, const End& b) { return a.position[axis] < b.position[axis]; });
    build(first, middle, (axis + 1) % 3);
    build(middle + 1, last, (axis + 1) % 3);
  }

  /// A part of the tree, and the part of an edge that passes it, as fractions of the edge.
  struct Node {
    std::size_t first, last;
    int axis;
    double from, to;
  };

  template <class Act>
  void visit(const Node& node, const Edge& edge, double tolerance, int& visits, const Act& act) const {
    if (node.first >= node.last || node.from > node.to || ++visits > kMostEnds) return;
    const std::size_t middle = (node.first + node.last) / 2;
    const double at = ends_[middle].position[node.axis], start = edge.from[node.axis], run = edge.to[node.axis] - start;
    Node below{node.first, middle, (node.axis + 1) % 3, node.from, node.to};
    Node above{middle + 1, node.last, (node.axis + 1) % 3, node.from, node.to};
    if (std::abs(run) > tolerance) {
      const double leaves_below = (at + tolerance - start) / run, leaves_above = (at - tolerance - start) / run;
      if (run > 0) {
        below.to = std::min(below.to, leaves_below);
        above.from = std::max(above.from, leaves_above);
      } else {
        below.from = std::max(below.from, leaves_below);
        above.to = std::min(above.to, leaves_above);
      }
    } else {
      if (start > at + 2 * tolerance) below.last = below.first;
      if (start < at - 2 * tolerance) above.last = above.first;
    }
    visit(below, edge, tolerance, visits, act);
    act(ends_[middle]);
    visit(above, edge, tolerance, visits, act);
  }

  std::vector<End> ends_;
};

/// A vertex on an edge: where, 0 to 1 along it.
struct OnEdge {
  double fraction = 0.0;
  Vec3d position{0.0};
};

/// The vertices on an edge at which another open edge that runs along it ends, in order.
std::vector<OnEdge> vertices_on(const Edge& edge, const std::vector<Edge>& edges, const EndTree& ends,
                                double tolerance) {
  const double length = edge.length(), most = std::min(tolerance, kOfSplitEdge * length);
  const auto is_on = [&](const Edge& of, const Vec3d& point) { return of.distance(point) <= most; };
  std::vector<OnEdge> found;
  const bool complete = ends.for_each_near(edge, most, [&](const EndTree::End& end) {
    const double along = edge.along(end.position);
    if (along <= most || along >= length - most || !is_on(edge, end.position)) return;
    const Edge& other = edges[end.edge];
    const Vec3d& far = other.from == end.position ? other.to : other.from;
    const double further = edge.along(far);
    const bool runs_along = further > 0 && further < length ? std::abs(further - along) > most && is_on(edge, far)
                                                            : is_on(other, further <= 0 ? edge.from : edge.to);
    if (runs_along) found.push_back({along / length, end.position});
  });
  if (!complete) return {};
  std::sort(found.begin(), found.end(), [](const OnEdge& a, const OnEdge& b) { return a.fraction < b.fraction; });
  found.erase(std::unique(found.begin(), found.end(),
                          [](const OnEdge& a, const OnEdge& b) { return a.position == b.position; }),
              found.end());
  return found;
}

/// A soup that grows by corners between those of another.
class Splitter {
 public:
  Splitter(const TriangleSoup& soup, const std::vector<Vec3d>& positions) : result_(soup) {
    result_.positions = positions;
  }

  /// Splits a triangle, whose edges may hold vertices. Shape of `on_edges`: from each corner to the next.
  void split(std::int32_t triangle, std::array<std::vector<OnEdge>, 3> on_edges) {
    for (int k = 0; k < 3; ++k) {
      if (on_edges[k].empty()) continue;
      // The part behind the first vertex on the edge stays the triangle; the part before it is a new one.
      const auto from = std::size_t(3 * triangle + k), to = next_corner(from), third = next_corner(to);
      const OnEdge at = on_edges[k].front();
      const std::int32_t part = append_triangle({from, to, third}, to, from, at);
      move_corner(from, to, at);
      std::array<std::vector<OnEdge>, 3> of_part;
      of_part[2] = std::exchange(on_edges[(k + 2) % 3], {});
      on_edges[k].erase(on_edges[k].begin());
      for (OnEdge& rest : on_edges[k]) rest.fraction = (rest.fraction - at.fraction) / (1 - at.fraction);
      split(part, std::move(of_part));
      split(triangle, std::move(on_edges));
      return;
    }
  }

  TriangleSoup take() { return std::move(result_); }

 private:
  template <class Value>
  static Value between(const Value& a, const Value& b, double fraction) {
    return a + (b - a) * typename Value::BaseType(fraction);
  }

  /// Calls act(values) for the corners' values of each kind.
  template <class Act>
  void for_each_kind(const Act& act) {
    act(result_.positions);
    if (!result_.normals.empty()) act(result_.normals);
    for (std::vector<Vec2f>& texcoords : result_.texcoords) act(texcoords);
    if (!result_.colors.empty()) act(result_.colors);
  }

  /// Appends a copy of three corners, of which `moved` lies between it and `from`.
  std::int32_t append_triangle(const std::array<std::size_t, 3>& corners, std::size_t moved, std::size_t from,
                               const OnEdge& at) {
    const auto triangle = std::int32_t(result_.positions.size() / 3);
    for_each_kind([&](auto& values) {
      for (const std::size_t corner : corners)
        values.push_back(corner == moved ? between(values[from], values[moved], at.fraction) : values[corner]);
    });
    settle(std::size_t(3 * triangle + 1), at);
    return triangle;
  }

  void move_corner(std::size_t corner, std::size_t to, const OnEdge& at) {
    for_each_kind([&](auto& values) { values[corner] = between(values[corner], values[to], at.fraction); });
    settle(corner, at);
  }

  void settle(std::size_t corner, const OnEdge& at) {
    result_.positions[corner] = at.position;
    if (!result_.normals.empty()) result_.normals[corner].normalize();
  }

  TriangleSoup result_;
};

}  // namespace

std::optional<TriangleSoup> split_at_t_vertices(const TriangleSoup& soup, const std::vector<Vec3d>& positions) {
  const double tolerance = position_tolerance(soup);
  if (!(tolerance > 0.0)) return std::nullopt;
  std::vector<Edge> edges;
  for (const std::int32_t corner : open_edges(weld_corners(positions)))
    edges.push_back({corner, positions[std::size_t(corner)], positions[next_corner(std::size_t(corner))]});
  const EndTree ends(edges);
  std::vector<std::pair<std::int32_t, std::vector<OnEdge>>> splits;  // by the corner that an edge starts at
  std::size_t count = 0;
  for (const Edge& edge : edges) {
    std::vector<OnEdge> found = vertices_on(edge, edges, ends, tolerance);
    count += found.size();
    if (!found.empty()) splits.emplace_back(edge.corner, std::move(found));
  }
  if (splits.empty() || count > edges.size()) return std::nullopt;
  std::sort(splits.begin(), splits.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Splitter splitter(soup, positions);
  for (std::size_t first = 0, last = 0; first < splits.size(); first = last) {
    const std::int32_t triangle = splits[first].first / 3;
    std::array<std::vector<OnEdge>, 3> on_edges;
    for (; last < splits.size() && splits[last].first / 3 == triangle; ++last)
      on_edges[std::size_t(splits[last].first % 3)] = std::move(splits[last].second);
    splitter.split(triangle, std::move(on_edges));
  }
  return splitter.take();
}

}  // namespace patchlight
