#include "importers/mesh/planar_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

using Imath::V2d;
using Edges = std::vector<std::array<Vec3d, 2>>;

/// The edges of a region's outline, without vertices inside of straight lines where these are known.
Edges edges_of(const MeshTopology& topology, const CoplanarRegion& region, const RegionOutline& outline) {
  Edges edges;
  for (std::size_t i = 0; i < outline.corners.size(); ++i)
    edges.push_back(
        {topology.vertices[outline.corners[i].vertex], topology.vertices[outline.corners[outline.next[i]].vertex]});
  if (!edges.empty()) return edges;
  for (const std::int32_t number : region.triangles) {
    const MeshTopology::Triangle& triangle = topology.triangles[number];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t other = triangle.neighbors[i];
      if (other >= 0 && std::binary_search(region.triangles.begin(), region.triangles.end(), other)) continue;
      edges.push_back({topology.vertices[triangle.vertices[i]], topology.vertices[triangle.vertices[(i + 1) % 3]]});
    }
  }
  return edges;
}

/// The direction in the plane, or across it, in which most of the outline runs; a unit vector.
Vec3d main_direction(const Edges& edges, const Vec3d& normal) {
  constexpr int kBins = 360;  // over a quarter turn
  const Vec3d x = (std::abs(normal.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)).cross(normal).normalized();
  const Vec3d y = normal.cross(x);
  const auto bin_of = [&](const Vec3d& edge) {
    const double turn = std::atan2(edge.dot(y), edge.dot(x)) / (0.5 * kPi);
    return static_cast<std::size_t>(std::lround((turn - std::floor(turn)) * kBins)) % kBins;
  };
  std::array<double, kBins> length{};
  for (const auto& [from, to] : edges) length[bin_of(to - from)] += (to - from).length();
  const auto best = static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
  Vec3d longest(0.0);
  for (const auto& [from, to] : edges)
    if (bin_of(to - from) == best && (to - from).length2() > longest.length2()) longest = to - from;
  return (longest - normal * longest.dot(normal)).normalized();
}

}  // namespace

Facet planar_region(const MeshTopology& topology, const CoplanarRegion& region, const RegionOutline& outline,
                    const std::vector<std::array<Vec3d, 4>>& pieces, std::int32_t& next_smooth) {
  const Edges edges = edges_of(topology, region, outline);
  const auto largest = *std::max_element(
      region.triangles.begin(), region.triangles.end(),
      [&](std::int32_t a, std::int32_t b) { return topology.triangles[a].area < topology.triangles[b].area; });
  const Vec3d along = main_direction(edges, region.normal), across = region.normal.cross(along);
  const auto corner_of = [&](std::int32_t triangle, std::size_t k) {
    return topology.vertices[topology.triangles[triangle].vertices[k]];
  };
  const Vec3d origin = corner_of(largest, 0);
  const auto in_plane = [&](const Vec3d& p) { return V2d((p - origin).dot(along), (p - origin).dot(across)); };
  V2d low(std::numeric_limits<double>::infinity()), high = -low;
  const auto extend = [&](const Vec3d& p) {
    for (int k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], in_plane(p)[k]);
      high[k] = std::max(high[k], in_plane(p)[k]);
    }
  };
  for (const std::int32_t triangle : region.triangles)
    for (std::size_t k = 0; k < 3; ++k) extend(corner_of(triangle, k));
  const auto uv_of = [&](const Vec3d& p) {
    const V2d uv = (in_plane(p) - low) / (high - low);
    return Vec2d(std::clamp(uv.x, 0.0, 1.0), std::clamp(uv.y, 0.0, 1.0));
  };

  Region result;
  const auto add_piece = [&](const std::array<Vec3d, 4>& c) {
    result.pieces.push_back({uv_of(c[0]), uv_of(c[1]), uv_of(c[2]), uv_of(c[3])});
  };
  for (const auto& piece : pieces) add_piece(piece);
  if (pieces.empty())
    for (const std::int32_t t : region.triangles)
      add_piece({corner_of(t, 0), corner_of(t, 1), corner_of(t, 2), corner_of(t, 2)});
  for (const auto& [from, to] : edges)
    if (uv_of(from) != uv_of(to)) result.edges.push_back({uv_of(from), uv_of(to)});

  Facet facet;
  const V2d e1 = in_plane(corner_of(largest, 1)), e2 = in_plane(corner_of(largest, 2));
  const double scale = 1.0 / e1.cross(e2);
  for (std::size_t k = 0; k < 4; ++k) {
    const V2d at(k == 1 || k == 2 ? high.x : low.x, k >= 2 ? high.y : low.y);
    facet.corners[k] = origin + along * at.x + across * at.y;
    facet.smooth_vertices[k] = next_smooth++;
    facet.sources[k] = {3 * largest, 3 * largest + 1, at.cross(e2) * scale, 3 * largest + 2, e1.cross(at) * scale};
  }
  facet.region = std::make_shared<const Region>(std::move(result));
  return facet;
}

}  // namespace patchlight
