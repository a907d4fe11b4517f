#include "importers/mesh/region_quads.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "importers/mesh/region_outline.h"

namespace patchlight {
namespace {

using Imath::V2d;

constexpr std::size_t kMostCorners = 512;  // cutting takes the square of them
constexpr double kLeastCornerSine = 1e-3;
constexpr double kSquareCosine = 1e-3;  // of a rectangle's corners
constexpr double kSliver = 0.01;        // area of a facet, in its longest edge squared
constexpr double kAreaRounding = 1e-9;

/// A corner of a facet: one of the outline, or a place on an edge of it where a cut ends.
struct Node {
  std::size_t corner = 0;
  double part = 0.0;  ///< Of the way to the next corner; 0: the corner itself.

  auto operator<=>(const Node&) const = default;
};

/// The facets that one direction of cuts gives, and what speaks against them.
struct Cutting {
  std::vector<std::array<Node, 4>> facets;
  bool slivers = false;
  bool rectangles = true;
  double area = 0.0;
};

class Cutter {
 public:
  Cutter(const RegionOutline& outline, double tolerance) : outline_(outline), tolerance_(tolerance) {}

  /// Cuts along `direction`; nothing where the outline crosses itself.
  std::optional<Cutting> cut(const V2d& direction);

  V2d place(const Node& node) const {
    const V2d& a = outline_.points[node.corner];
    return a + (outline_.points[outline_.next[node.corner]] - a) * node.part;
  }

  /// Adds a facet. False for one that is not convex.
  bool add(const std::array<Node, 4>& facet, Cutting& cutting) const;

 private:
  /// An edge of the outline between two levels of cuts.
  struct Edge {
    std::size_t start;  ///< Its corner of the outline.
    int low, high;      ///< Levels.
    bool rises;         ///< It starts below.
  };
  /// A facet that grows upwards between two edges.
  struct Open {
    std::size_t left, right;  ///< Edges.
    int low;
  };

  void find_levels(const V2d& up);
  Node node_at(const Edge& edge, int level) const;
  bool close(const Open& open, int level, Cutting& cutting) const;

  const RegionOutline& outline_;
  double tolerance_;
  std::vector<double> heights_;  ///< Of the corners.
  std::vector<double> levels_;   ///< Heights of the cuts.
  std::vector<Edge> edges_;
};

/// Corners of nearly one height share a level; edges within a level are left out.
void Cutter::find_levels(const V2d& up) {
  const std::size_t n = outline_.points.size();
  heights_.assign(n, 0.0);
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) heights_[i] = outline_.points[i].dot(up), order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return heights_[a] < heights_[b] || (heights_[a] == heights_[b] && a < b);
  });
  levels_.clear();
  std::vector<int> level(n, 0);
  for (const std::size_t i : order) {
    if (levels_.empty() || heights_[i] > levels_.back() + 4.0 * tolerance_) levels_.push_back(heights_[i]);
    level[i] = static_cast<int>(levels_.size()) - 1;
  }
  edges_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const int a = level[i], b = level[outline_.next[i]];
    if (a != b) edges_.push_back({i, std::min(a, b), std::max(a, b), a < b});
  }
}

Node Cutter::node_at(const Edge& edge, int level) const {
  const std::size_t end = outline_.next[edge.start];
  if (level == (edge.rises ? edge.low : edge.high)) return {edge.start, 0.0};
  if (level == (edge.rises ? edge.high : edge.low)) return {end, 0.0};
  const double from = heights_[edge.start];
  return {edge.start, (levels_[static_cast<std::size_t>(level)] - from) / (heights_[end] - from)};
}

bool Cutter::close(const Open& open, int level, Cutting& cutting) const {
  const Node a = node_at(edges_[open.left], open.low), b = node_at(edges_[open.right], open.low);
  const Node c = node_at(edges_[open.right], level), d = node_at(edges_[open.left], level);
  if (a == b) return c != d && add({c, d, a, a}, cutting);
  return add({a, b, c, d}, cutting);
}

bool Cutter::add(const std::array<Node, 4>& facet, Cutting& cutting) const {
  std::array<V2d, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = place(facet[i]);
  const std::size_t corners = facet[2] == facet[3] ? 3 : 4;
  double longest = 0.0;
  for (std::size_t i = 0; i < corners; ++i) {
    const V2d in = p[(i + 1) % corners] - p[i], out = p[(i + 2) % corners] - p[(i + 1) % corners];
    const double lengths = in.length() * out.length();
    if (!(in.cross(out) > kLeastCornerSine * lengths)) return false;
    if (std::abs(in.dot(out)) > kSquareCosine * lengths) cutting.rectangles = false;
    longest = std::max(longest, in.length());
  }
  const double area = (p[2] - p[0]).cross(p[3] - p[1]) * 0.5;
  cutting.slivers = cutting.slivers || area < kSliver * longest * longest;
  cutting.rectangles = cutting.rectangles && corners == 4;
  cutting.area += area;
  cutting.facets.push_back(facet);
  return true;
}

std::optional<Cutting> Cutter::cut(const V2d& direction) {
  const V2d up(-direction.y, direction.x);
  find_levels(up);
  Cutting cutting;
  std::vector<Open> open;
  for (int k = 0; k + 1 < static_cast<int>(levels_.size()); ++k) {
    const double middle = (levels_[static_cast<std::size_t>(k)] + levels_[static_cast<std::size_t>(k) + 1]) * 0.5;
    std::vector<std::pair<double, std::size_t>> crossed;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (edges_[e].low > k || edges_[e].high <= k) continue;
      const std::size_t start = edges_[e].start, end = outline_.next[start];
      const double part = (middle - heights_[start]) / (heights_[end] - heights_[start]);
      crossed.emplace_back(place({start, part}).dot(direction), e);
    }
    if (crossed.size() % 2 != 0) return std::nullopt;
    std::sort(crossed.begin(), crossed.end());
    std::vector<Open> above;
    for (std::size_t i = 0; i < crossed.size(); i += 2) {
      const std::size_t left = crossed[i].second, right = crossed[i + 1].second;
      if (edges_[left].rises || !edges_[right].rises) return std::nullopt;  // the region is not between them
      const auto below =
          std::find_if(open.begin(), open.end(), [&](const Open& o) { return o.left == left && o.right == right; });
      if (below == open.end()) {
        above.push_back({left, right, k});
      } else {
        above.push_back(*below);
        open.erase(below);
      }
    }
    for (const Open& ended : open) {
      if (!close(ended, k, cutting)) return std::nullopt;
    }
    open = std::move(above);
  }
  for (const Open& ended : open) {
    if (!close(ended, static_cast<int>(levels_.size()) - 1, cutting)) return std::nullopt;
  }
  return cutting;
}

/// The better of the cuttings along and across the longest edge.
std::optional<Cutting> best_cutting(const RegionOutline& outline, Cutter& cutter) {
  V2d longest(0.0, 0.0);
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const V2d edge = outline.points[outline.next[i]] - outline.points[i];
    if (edge.length2() > longest.length2() * (1.0 + 1e-9)) longest = edge;
  }
  const V2d along = longest.normalized();
  std::optional<Cutting> best;
  for (const V2d& direction : {along, V2d(-along.y, along.x)}) {
    std::optional<Cutting> cutting = cutter.cut(direction);
    const auto order = [](const Cutting& c) { return std::pair(c.slivers, c.facets.size()); };
    if (cutting && (!best || order(*cutting) < order(*best))) best = std::move(cutting);
  }
  return best;
}

double area_of(const MeshTopology& topology, const CoplanarRegion& region) {
  double area = 0.0;
  for (const std::int32_t triangle : region.triangles) area += topology.triangles[triangle].area;
  return area;
}

double perimeter_of(const RegionOutline& outline) {
  double length = 0.0;
  for (std::size_t i = 0; i < outline.points.size(); ++i)
    length += (outline.points[outline.next[i]] - outline.points[i]).length();
  return length;
}

/// Facets in space, and where they are on the mesh.
std::vector<Facet> placed(const MeshTopology& topology, const RegionOutline& outline, const Cutting& cutting,
                          std::int32_t& next_smooth) {
  std::map<Node, std::int32_t> new_corners;
  std::vector<Facet> facets;
  for (const std::array<Node, 4>& source : cutting.facets) {
    Facet& facet = facets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      const CoplanarRegion::Corner& corner = outline.corners[source[i].corner];
      const CoplanarRegion::Corner& next = outline.corners[outline.next[source[i].corner]];
      facet.corners[i] = CornerSource{corner.vertex, next.vertex, source[i].part}(topology.vertices);
      facet.sources[i] = {corner.number(), next.number(), source[i].part};
      if (source[i].part == 0.0) {
        facet.smooth_vertices[i] =
            topology.triangles[corner.triangle].smooth_vertices[static_cast<std::size_t>(corner.index)];
      } else {
        const auto [entry, is_new] = new_corners.emplace(source[i], next_smooth);
        if (is_new) ++next_smooth;
        facet.smooth_vertices[i] = entry->second;
      }
    }
  }
  return facets;
}

}  // namespace

std::vector<Facet> region_quads(const MeshTopology& topology, const CoplanarRegion& region, std::size_t most,
                                std::int32_t& next_smooth) {
  const RegionOutline outline = outline_of(topology, region);
  const std::size_t corners = outline.corners.size();
  if (corners < 3 || corners > kMostCorners) return {};
  Cutter cutter(outline, region.tolerance);
  std::optional<Cutting> cutting;
  if (corners <= 4) {  // one loop
    cutting.emplace();
    if (!cutter.add({Node{0}, Node{1}, Node{2}, Node{corners - 1}}, *cutting)) cutting.reset();
  }
  if (!cutting && !outline.needs_vertices) {
    cutting = best_cutting(outline, cutter);
    if (cutting && !cutting->rectangles && (cutting->slivers || 2 * cutting->facets.size() > most)) return {};
  }
  if (!cutting || cutting->facets.size() > most) return {};
  const double error = 2.0 * region.tolerance * perimeter_of(outline) + kAreaRounding * cutting->area;
  if (!(std::abs(cutting->area - area_of(topology, region)) <= error)) return {};
  return placed(topology, outline, *cutting, next_smooth);
}

}  // namespace patchlight
