#include "importers/mesh/region_quads.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "importers/mesh/planar_region.h"
#include "importers/mesh/region_outline.h"

namespace patchlight {
namespace {

using Imath::V2d;

constexpr std::size_t kMaxCorners = 512;  // decomposition takes quadratic time
constexpr double kMinCornerSine = 1e-3;
constexpr double kRightAngleCosine = 1e-3;
constexpr double kSliver = 0.01;  // area / squared longest edge of a facet
constexpr double kAreaRounding = 1e-9;

/// A corner of a facet: a point on the outline.
struct OutlinePoint {
  std::size_t corner = 0;
  double fraction = 0.0;  ///< Of the edge to the next corner; 0: the corner itself.

  auto operator<=>(const OutlinePoint&) const = default;
};

/// Facets of an outline and their quality.
struct Decomposition {
  std::vector<std::array<OutlinePoint, 4>> facets;
  bool has_slivers = false;
  bool all_rectangles = true;
  double area = 0.0;
};

/// Trapezoidal decomposition of an outline by a sweep line.
class TrapezoidSweep {
 public:
  TrapezoidSweep(const RegionOutline& outline, double tolerance) : outline_(outline), tolerance_(tolerance) {}

  /// Splits the outline by lines along `direction` through its corners; nothing if the outline intersects itself.
  std::optional<Decomposition> decompose(const V2d& direction);

  V2d position(const OutlinePoint& point) const {
    const V2d& a = outline_.points[point.corner];
    return a + (outline_.points[outline_.next[point.corner]] - a) * point.fraction;
  }

  /// Adds a facet. False for one that is not convex.
  bool add_facet(const std::array<OutlinePoint, 4>& facet, Decomposition& result) const;

 private:
  /// An edge of the outline between two levels.
  struct Edge {
    std::size_t start;  ///< Corner of the outline.
    int low, high;      ///< Levels.
    bool rises;         ///< From low to high.
  };
  /// A trapezoid between two edges whose upper side is not reached yet.
  struct OpenTrapezoid {
    std::size_t left, right;  ///< Indices into edges_.
    int low;
  };

  void find_levels(const V2d& up);
  OutlinePoint point_at(const Edge& edge, int level) const;
  bool close_trapezoid(const OpenTrapezoid& open, int level, Decomposition& result) const;

  const RegionOutline& outline_;
  double tolerance_;
  std::vector<double> heights_;  ///< Of the corners, m.
  std::vector<double> levels_;   ///< Heights of the dividing lines, m.
  std::vector<Edge> edges_;
};

/// Corners of nearly equal height share a level; edges within a level are omitted.
void TrapezoidSweep::find_levels(const V2d& up) {
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

OutlinePoint TrapezoidSweep::point_at(const Edge& edge, int level) const {
  const std::size_t end = outline_.next[edge.start];
  if (level == (edge.rises ? edge.low : edge.high)) return {edge.start, 0.0};
  if (level == (edge.rises ? edge.high : edge.low)) return {end, 0.0};
  const double from = heights_[edge.start];
  return {edge.start, (levels_[static_cast<std::size_t>(level)] - from) / (heights_[end] - from)};
}

bool TrapezoidSweep::close_trapezoid(const OpenTrapezoid& open, int level, Decomposition& result) const {
  const OutlinePoint a = point_at(edges_[open.left], open.low), b = point_at(edges_[open.right], open.low);
  const OutlinePoint c = point_at(edges_[open.right], level), d = point_at(edges_[open.left], level);
  if (a == b) return c != d && add_facet({c, d, a, a}, result);
  return add_facet({a, b, c, d}, result);
}

bool TrapezoidSweep::add_facet(const std::array<OutlinePoint, 4>& facet, Decomposition& result) const {
  std::array<V2d, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = position(facet[i]);
  const std::size_t corners = facet[2] == facet[3] ? 3 : 4;
  double longest = 0.0;
  for (std::size_t i = 0; i < corners; ++i) {
    const V2d in = p[(i + 1) % corners] - p[i], out = p[(i + 2) % corners] - p[(i + 1) % corners];
    const double lengths = in.length() * out.length();
    if (!(in.cross(out) > kMinCornerSine * lengths)) return false;
    if (std::abs(in.dot(out)) > kRightAngleCosine * lengths) result.all_rectangles = false;
    longest = std::max(longest, in.length());
  }
  const double area = (p[2] - p[0]).cross(p[3] - p[1]) * 0.5;
  result.has_slivers = result.has_slivers || area < kSliver * longest * longest;
  result.all_rectangles = result.all_rectangles && corners == 4;
  result.area += area;
  result.facets.push_back(facet);
  return true;
}

std::optional<Decomposition> TrapezoidSweep::decompose(const V2d& direction) {
  const V2d up(-direction.y, direction.x);
  find_levels(up);
  Decomposition result;
  std::vector<OpenTrapezoid> open;
  for (int k = 0; k + 1 < static_cast<int>(levels_.size()); ++k) {
    const double middle = (levels_[static_cast<std::size_t>(k)] + levels_[static_cast<std::size_t>(k) + 1]) * 0.5;
    std::vector<std::pair<double, std::size_t>> crossed;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (edges_[e].low > k || edges_[e].high <= k) continue;
      const std::size_t start = edges_[e].start, end = outline_.next[start];
      const double fraction = (middle - heights_[start]) / (heights_[end] - heights_[start]);
      crossed.emplace_back(position({start, fraction}).dot(direction), e);
    }
    if (crossed.size() % 2 != 0) return std::nullopt;
    std::sort(crossed.begin(), crossed.end());
    std::vector<OpenTrapezoid> above;
    for (std::size_t i = 0; i < crossed.size(); i += 2) {
      const std::size_t left = crossed[i].second, right = crossed[i + 1].second;
      if (edges_[left].rises || !edges_[right].rises) return std::nullopt;  // the region is not between these edges
      const auto below = std::find_if(open.begin(), open.end(),
                                      [&](const OpenTrapezoid& o) { return o.left == left && o.right == right; });
      if (below == open.end()) {
        above.push_back({left, right, k});
      } else {
        above.push_back(*below);
        open.erase(below);
      }
    }
    for (const OpenTrapezoid& ended : open) {
      if (!close_trapezoid(ended, k, result)) return std::nullopt;
    }
    open = std::move(above);
  }
  for (const OpenTrapezoid& ended : open) {
    if (!close_trapezoid(ended, static_cast<int>(levels_.size()) - 1, result)) return std::nullopt;
  }
  return result;
}

/// The better of the decompositions along and across the longest edge: without slivers, then with fewer facets.
std::optional<Decomposition> best_decomposition(const RegionOutline& outline, TrapezoidSweep& sweep) {
  V2d longest(0.0, 0.0);
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const V2d edge = outline.points[outline.next[i]] - outline.points[i];
    if (edge.length2() > longest.length2() * (1.0 + 1e-9)) longest = edge;
  }
  const V2d along = longest.normalized();
  std::optional<Decomposition> best;
  for (const V2d& direction : {along, V2d(-along.y, along.x)}) {
    std::optional<Decomposition> found = sweep.decompose(direction);
    const auto order = [](const Decomposition& d) { return std::pair(d.has_slivers, d.facets.size()); };
    if (found && (!best || order(*found) < order(*best))) best = std::move(found);
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

/// The facets in 3D, and the corners of the mesh that they take their values from.
std::vector<Facet> facets_in_space(const MeshTopology& topology, const RegionOutline& outline,
                                   const Decomposition& found, std::int32_t& next_smooth) {
  std::map<OutlinePoint, std::int32_t> new_corners;
  std::vector<Facet> facets;
  for (const std::array<OutlinePoint, 4>& source : found.facets) {
    Facet& facet = facets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      const CoplanarRegion::Corner& corner = outline.corners[source[i].corner];
      const CoplanarRegion::Corner& next = outline.corners[outline.next[source[i].corner]];
      facet.corners[i] = CornerSource{corner.vertex, next.vertex, source[i].fraction}(topology.vertices);
      facet.sources[i] = {corner.corner_index(), next.corner_index(), source[i].fraction};
      if (source[i].fraction == 0.0) {
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

std::vector<Facet> region_quads(const MeshTopology& topology, const CoplanarRegion& region, std::size_t max_facets,
                                bool as_regions, std::int32_t& next_smooth) {
  const RegionOutline outline = outline_of(topology, region);
  const std::size_t corners = outline.corners.size();
  std::optional<Decomposition> found;
  if (corners >= 3 && corners <= kMaxCorners) {
    TrapezoidSweep sweep(outline, region.tolerance);
    if (corners <= 4) {  // a single loop
      found.emplace();
      const std::array whole{OutlinePoint{0}, OutlinePoint{1}, OutlinePoint{2}, OutlinePoint{corners - 1}};
      if (!sweep.add_facet(whole, *found)) found.reset();
    }
    if (!found && !region.bends) found = best_decomposition(outline, sweep);
    const auto has_area_of_region = [&] {
      const double error = 2.0 * region.tolerance * perimeter_of(outline) + kAreaRounding * found->area;
      return std::abs(found->area - area_of(topology, region)) <= error;
    };
    if (found && !has_area_of_region()) found.reset();
  }
  const bool few = found && found->facets.size() <= max_facets;
  if (few && (found->facets.size() == 1 || found->all_rectangles))
    return facets_in_space(topology, outline, *found, next_smooth);
  if (as_regions && !region.bends && topology.colors.empty()) {
    std::vector<std::array<Vec3d, 4>> pieces;
    std::int32_t unused = next_smooth;
    if (found && found->facets.size() <= region.triangles.size())
      for (const Facet& facet : facets_in_space(topology, outline, *found, unused)) pieces.push_back(facet.corners);
    return {planar_region(topology, region, outline, pieces, next_smooth)};
  }
  if (!few || found->has_slivers || 2 * found->facets.size() > max_facets) return {};
  return facets_in_space(topology, outline, *found, next_smooth);
}

}  // namespace patchlight
