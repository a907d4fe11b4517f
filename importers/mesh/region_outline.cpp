#include "importers/mesh/region_outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

using Imath::V2d;

constexpr std::size_t kMaxVertices = 8192;  // of a loop; simplification takes quadratic time at worst

double distance_to_segment(const V2d& p, const V2d& a, const V2d& b) {
  const V2d edge = b - a;
  const double length2 = edge.length2();
  if (!(length2 > 0.0)) return (p - a).length();
  const double t = std::clamp((p - a).dot(edge) / length2, 0.0, 1.0);
  return (p - (a + edge * t)).length();
}

std::size_t farthest_from(const std::vector<V2d>& points, const V2d& from) {
  std::size_t result = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if ((points[i] - from).length2() > (points[result] - from).length2()) result = i;
  }
  return result;
}

/// Simplifies a loop (Douglas and Peucker 1973): marks the vertices to keep. All others lie within the tolerance of an
/// edge between these. Vertices already marked in `kept` stay.
std::vector<char> simplify_loop(const std::vector<V2d>& points, std::vector<char> kept, double tolerance) {
  const std::size_t n = points.size();
  V2d mean(0.0, 0.0);
  for (const V2d& p : points) mean += p / static_cast<double>(n);
  const std::size_t start = farthest_from(points, mean);
  kept[start] = kept[farthest_from(points, points[start])] = 1;
  std::vector<std::pair<std::size_t, std::size_t>> pending;
  for (std::size_t i = start + 1, from = start; i <= start + n; ++i) {
    if (!kept[i % n]) continue;
    pending.emplace_back(from, i);
    from = i;
  }
  while (!pending.empty()) {
    const auto [from, to] = pending.back();
    pending.pop_back();
    double largest = tolerance;
    std::size_t corner = from;
    for (std::size_t i = from + 1; i < to; ++i) {
      const double distance = distance_to_segment(points[i % n], points[from % n], points[to % n]);
      if (distance > largest) largest = distance, corner = i;
    }
    if (corner == from) continue;
    kept[corner % n] = 1;
    pending.emplace_back(from, corner);
    pending.emplace_back(corner, to);
  }
  return kept;
}

}  // namespace

RegionOutline outline_of(const MeshTopology& topology, const CoplanarRegion& region) {
  const Vec3d& n = region.normal;
  const Vec3d x = (std::abs(n.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)).cross(n).normalized();
  const Vec3d y = n.cross(x);
  RegionOutline outline;
  for (const auto& loop : region.loops) {
    if (loop.size() > kMaxVertices) return {};
    const Vec3d& origin = topology.vertices[region.loops[0][0].vertex];
    std::vector<V2d> points;
    std::vector<char> required;
    for (const CoplanarRegion::Corner& corner : loop) {
      const Vec3d to = topology.vertices[corner.vertex] - origin;
      points.emplace_back(to.dot(x), to.dot(y));
      required.push_back(corner.required ? 1 : 0);
    }
    const std::vector<char> kept = simplify_loop(points, required, region.tolerance);
    const std::size_t first = outline.corners.size();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (!kept[i]) continue;
      outline.corners.push_back(loop[i]);
      outline.points.push_back(points[i]);
      outline.next.push_back(outline.corners.size());
    }
    outline.next.back() = first;
  }
  return outline;
}

}  // namespace patchlight
