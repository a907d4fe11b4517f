#include "importers/mesh/coplanar_regions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace patchlight {
namespace {

constexpr double kPlaneTolerance = 1e-6;     // distance from the plane / longest edge of the seed triangle
constexpr double kRoundingTolerance = 4.0;   // distance from the plane / rounding error of positions
constexpr double kCoplanarSine = 1e-3;       // of the angle between neighbouring triangles
constexpr double kTexcoordTolerance = 2e-5;  // relative to the distance from the seed triangle's coordinates
constexpr double kFloatRounding = 1e-7;
constexpr double kColorStep = 1.0 / 256;
constexpr double kNormalStep = 0.02;  // between the file's normals
constexpr std::int32_t kNone = -1;

using Triangle = MeshTopology::Triangle;

/// A region's first triangle: its plane, and the affine maps of its texture coordinates and colours.
class Seed {
 public:
  Seed(const MeshTopology& topology, std::int32_t triangle)
      : topology_(topology), triangle_(triangle), first_corner_(3 * static_cast<std::size_t>(triangle)) {
    const auto& v = topology.triangles[triangle].vertices;
    origin = topology.vertices[v[0]];
    edge1_ = topology.vertices[v[1]] - origin;
    edge2_ = topology.vertices[v[2]] - origin;
    normal = topology.triangles[triangle].normal;
    cross_ = edge1_.cross(edge2_);
    const double longest = std::sqrt(std::max({edge1_.length2(), edge2_.length2(), (edge2_ - edge1_).length2()}));
    tolerance = kPlaneTolerance * longest + kRoundingTolerance * topology.rounding;
  }

  /// Whether a triangle lies in the plane and its values in the affine maps.
  bool accepts(std::int32_t number) const {
    const Triangle& triangle = topology_.triangles[number];
    if (!(triangle.normal.dot(normal) > 0.5) || !flat_by_normals(topology_, triangle_, number)) return false;
    for (int i = 0; i < 3; ++i) {
      const Vec3d to = topology_.vertices[triangle.vertices[i]] - origin;
      const double a = to.cross(edge2_).dot(cross_) / cross_.length2();
      const double b = edge1_.cross(to).dot(cross_) / cross_.length2();
      // Rounding errors of the seed triangle grow with the distance from it.
      const double growth = 1.0 + std::abs(a) + std::abs(b);
      if (!(std::abs(normal.dot(to)) <= tolerance + kRoundingTolerance * topology_.rounding * growth)) return false;
      if (!matches_maps(a, b, 3 * static_cast<std::size_t>(number) + static_cast<std::size_t>(i))) return false;
    }
    return true;
  }

  Vec3d origin{0.0};
  Vec3d normal{0.0};
  double tolerance = 0.0;  ///< Distance from the plane near the seed triangle, m.

 private:
  /// Whether normal, colour and texture coordinates of a corner at origin + a edge1 + b edge2 equal the affine
  /// extrapolation from the seed triangle.
  bool matches_maps(double a, double b, std::size_t corner) const {
    if (!matches_normals(a, b, corner)) return false;
    if (!topology_.colors.empty()) {
      using Imath::V4d;
      const Vec4f* c = &topology_.colors[first_corner_];
      const V4d expected = V4d(c[0]) + V4d(c[1] - c[0]) * a + V4d(c[2] - c[0]) * b;
      if (!((V4d(topology_.colors[corner]) - expected).length() <= kColorStep)) return false;
    }
    return std::all_of(topology_.texcoords.begin(), topology_.texcoords.end(),
                       [&](const auto& texcoords) { return matches_map(texcoords, a, b, corner); });
  }

  /// Normals that are the same up to rounding count as constant: their extrapolation would magnify the rounding.
  bool matches_normals(double a, double b, std::size_t corner) const {
    const Vec3f* n = &topology_.normals[first_corner_];
    const Vec3d first(n[0]), along(n[1] - n[0]), across(n[2] - n[0]);
    const bool constant = std::max(along.length(), across.length()) <= kNormalStep;
    const Vec3d expected = constant ? first : first + along * a + across * b;
    return (Vec3d(topology_.normals[corner]) - expected).length() <= kNormalStep;
  }

  bool matches_map(const std::vector<Vec2f>& texcoords, double a, double b, std::size_t corner) const {
    const Vec2f* t = &texcoords[first_corner_];
    const Vec2f& found = texcoords[corner];
    if (std::isnan(t[0].x) || std::isnan(found.x)) return std::isnan(t[0].x) == std::isnan(found.x);
    const Imath::V2d start(t[0]), along = Imath::V2d(t[1]) - start, across = Imath::V2d(t[2]) - start;
    const Imath::V2d expected = start + along * a + across * b;
    const double largest = std::max({Imath::V2d(t[0]).length(), Imath::V2d(t[1]).length(), Imath::V2d(t[2]).length()});
    const double slope = std::max(along.length() / edge1_.length(), across.length() / edge2_.length());  // 1/m
    const double rounding =
        kFloatRounding * largest + topology_.texcoord_rounding + kRoundingTolerance * topology_.rounding * slope;
    return (Imath::V2d(found) - expected).length() <=
           kTexcoordTolerance * (expected - start).length() + rounding * (1.0 + std::abs(a) + std::abs(b));
  }

  const MeshTopology& topology_;
  std::int32_t triangle_;
  std::size_t first_corner_;
  Vec3d edge1_, edge2_, cross_;
};

/// Whether the surface continues smoothly across an edge into another plane.
bool is_smooth_bend(const MeshTopology& topology, const Triangle& triangle, int edge) {
  const std::int32_t other = triangle.neighbors[edge];
  if (other < 0) return false;
  const Triangle& neighbor = topology.triangles[other];
  if (triangle.normal.cross(neighbor.normal).length() <= kCoplanarSine && triangle.normal.dot(neighbor.normal) > 0.0)
    return false;
  for (int i = 0; i < 3; ++i) {
    if (neighbor.vertices[i] == triangle.vertices[edge] &&
        neighbor.smooth_vertices[i] == triangle.smooth_vertices[edge])
      return true;
  }
  return false;
}

/// The boundary as closed loops; empty if loops touch each other or themselves in a vertex.
std::vector<std::vector<CoplanarRegion::Corner>> boundary_loops(const MeshTopology& topology,
                                                                const std::vector<std::int32_t>& triangles,
                                                                const std::vector<std::int32_t>& region) {
  std::unordered_map<std::int32_t, CoplanarRegion::Corner> outgoing;  // boundary edges, by start vertex
  std::unordered_map<std::int32_t, std::int32_t> end_vertex;          // of these edges
  for (const std::int32_t number : triangles) {
    const Triangle& triangle = topology.triangles[number];
    for (int i = 0; i < 3; ++i) {
      const std::int32_t other = triangle.neighbors[i];
      if (other >= 0 && region[other] == region[number]) continue;
      CoplanarRegion::Corner corner{triangle.vertices[i], number, i, is_smooth_bend(topology, triangle, i)};
      if (!outgoing.emplace(corner.vertex, corner).second) return {};
      end_vertex[corner.vertex] = triangle.vertices[(i + 1) % 3];
    }
  }
  std::vector<std::vector<CoplanarRegion::Corner>> loops;
  for (const std::int32_t number : triangles) {
    for (const std::int32_t start : topology.triangles[number].vertices) {
      auto edge = outgoing.find(start);
      if (edge == outgoing.end()) continue;
      auto& loop = loops.emplace_back();
      while (edge != outgoing.end()) {
        loop.push_back(edge->second);
        const std::int32_t next = end_vertex[edge->first];
        outgoing.erase(edge);
        edge = outgoing.find(next);
      }
      // A smooth edge requires both its end vertices.
      std::vector<char> required(loop.size(), 0);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        if (loop[i].required) required[i] = required[(i + 1) % loop.size()] = 1;
      }
      for (std::size_t i = 0; i < loop.size(); ++i) loop[i].required = required[i] != 0;
    }
  }
  return loops;
}

}  // namespace

std::vector<CoplanarRegion> find_coplanar_regions(const MeshTopology& topology, const std::vector<char>& excluded) {
  std::vector<std::int32_t> order(topology.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return topology.triangles[a].area > topology.triangles[b].area;
  });
  std::vector<std::int32_t> region(topology.triangles.size(), kNone);
  std::vector<CoplanarRegion> regions;
  std::int32_t number = 0;
  for (const std::int32_t first : order) {
    if (excluded[first] || region[first] != kNone) continue;
    const Seed seed(topology, first);
    std::vector<std::int32_t> members{first};
    region[first] = number;
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (const std::int32_t neighbor : topology.triangles[members[i]].neighbors) {
        if (neighbor < 0 || excluded[neighbor] || region[neighbor] != kNone || !seed.accepts(neighbor)) continue;
        region[neighbor] = number;
        members.push_back(neighbor);
      }
    }
    ++number;
    if (members.size() < 3) continue;
    std::sort(members.begin(), members.end());
    CoplanarRegion& found = regions.emplace_back();
    found.loops = boundary_loops(topology, members, region);
    found.bends = std::any_of(members.begin(), members.end(), [&](std::int32_t t) {
      const Triangle& triangle = topology.triangles[t];
      for (int i = 0; i < 3; ++i) {
        const std::int32_t other = triangle.neighbors[i];
        if (other >= 0 && region[other] != region[t] && is_smooth_bend(topology, triangle, i)) return true;
      }
      return false;
    });
    found.triangles = std::move(members);
    found.normal = seed.normal;
    found.tolerance = seed.tolerance;
  }
  return regions;
}

}  // namespace patchlight
