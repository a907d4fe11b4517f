#include "importers/mesh/coplanar_regions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace patchlight {
namespace {

constexpr double kFlatness = 1e-6;      // distance from the plane, in longest edges of the first triangle
constexpr double kRoundings = 4.0;      // and in roundings of positions
constexpr double kCoplanarSine = 1e-3;  // of the angle to a smooth neighbour that bends away
constexpr double kMapping = 2e-5;       // of texture coordinates, in their distance from the first triangle's
constexpr double kFloatRounding = 1e-7;
constexpr double kColorStep = 1.0 / 256;
constexpr std::int32_t kNone = -1;

using Triangle = MeshTopology::Triangle;

/// The plane and the maps of a region's first triangle.
class Seed {
 public:
  Seed(const MeshTopology& topology, std::int32_t triangle)
      : topology_(topology), number_(triangle), first_(3 * static_cast<std::size_t>(triangle)) {
    const auto& v = topology.triangles[triangle].vertices;
    origin = topology.vertices[v[0]];
    along_ = topology.vertices[v[1]] - origin;
    up_ = topology.vertices[v[2]] - origin;
    normal = topology.triangles[triangle].normal;
    cross_ = along_.cross(up_);
    const double longest = std::sqrt(std::max({along_.length2(), up_.length2(), (up_ - along_).length2()}));
    tolerance = kFlatness * longest + kRoundings * topology.rounding;
  }

  bool takes(std::int32_t number) const {
    const Triangle& triangle = topology_.triangles[number];
    if (!(triangle.normal.dot(normal) > 0.5) || !flat_by_normals(topology_, number_, number)) return false;
    for (int i = 0; i < 3; ++i) {
      const Vec3d to = topology_.vertices[triangle.vertices[i]] - origin;
      const double a = to.cross(up_).dot(cross_) / cross_.length2();
      const double b = along_.cross(to).dot(cross_) / cross_.length2();
      // The farther off, the more the first triangle's own rounding tells.
      const double reach = 1.0 + std::abs(a) + std::abs(b);
      if (!(std::abs(normal.dot(to)) <= tolerance + kRoundings * topology_.rounding * reach)) return false;
      if (!maps(a, b, 3 * static_cast<std::size_t>(number) + static_cast<std::size_t>(i))) return false;
    }
    return true;
  }

  Vec3d origin{0.0};
  Vec3d normal{0.0};
  double tolerance = 0.0;  ///< Of places near by.

 private:
  /// Whether a corner at `a` and `b` along the first triangle's edges has what that one's maps say.
  bool maps(double a, double b, std::size_t corner) const {
    if (!topology_.colors.empty()) {
      using Imath::V4d;
      const Vec4f* c = &topology_.colors[first_];
      const V4d expected = V4d(c[0]) + V4d(c[1] - c[0]) * a + V4d(c[2] - c[0]) * b;
      if (!((V4d(topology_.colors[corner]) - expected).length() <= kColorStep)) return false;
    }
    return std::all_of(topology_.texcoords.begin(), topology_.texcoords.end(),
                       [&](const auto& texcoords) { return maps(texcoords, a, b, corner); });
  }

  bool maps(const std::vector<Vec2f>& texcoords, double a, double b, std::size_t corner) const {
    const Vec2f* t = &texcoords[first_];
    const Vec2f& found = texcoords[corner];
    if (std::isnan(t[0].x) || std::isnan(found.x)) return std::isnan(t[0].x) == std::isnan(found.x);
    const Imath::V2d start(t[0]);
    const Imath::V2d expected = start + (Imath::V2d(t[1]) - start) * a + (Imath::V2d(t[2]) - start) * b;
    const double largest = std::max({Imath::V2d(t[0]).length(), Imath::V2d(t[1]).length(), Imath::V2d(t[2]).length()});
    const double rounding = kFloatRounding * largest + topology_.texcoord_rounding;
    return (Imath::V2d(found) - expected).length() <=
           kMapping * (expected - start).length() + rounding * (1.0 + std::abs(a) + std::abs(b));
  }

  const MeshTopology& topology_;
  std::int32_t number_;
  std::size_t first_;  ///< Its first corner's number.
  Vec3d along_, up_, cross_;
};

/// Whether a smooth surface goes on across an edge and bends.
bool bends_smoothly(const MeshTopology& topology, const Triangle& triangle, int edge) {
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

/// The boundary as closed loops; none if two of them touch in a vertex.
std::vector<std::vector<CoplanarRegion::Corner>> boundary_loops(const MeshTopology& topology,
                                                                const std::vector<std::int32_t>& triangles,
                                                                const std::vector<std::int32_t>& region) {
  std::unordered_map<std::int32_t, CoplanarRegion::Corner> leaving;  // by the vertex where a boundary edge starts
  std::unordered_map<std::int32_t, std::int32_t> next;
  for (const std::int32_t number : triangles) {
    const Triangle& triangle = topology.triangles[number];
    for (int i = 0; i < 3; ++i) {
      const std::int32_t other = triangle.neighbors[i];
      if (other >= 0 && region[other] == region[number]) continue;
      CoplanarRegion::Corner corner{triangle.vertices[i], number, i, bends_smoothly(topology, triangle, i)};
      if (!leaving.emplace(corner.vertex, corner).second) return {};
      next[corner.vertex] = triangle.vertices[(i + 1) % 3];
    }
  }
  std::vector<std::vector<CoplanarRegion::Corner>> loops;
  for (const std::int32_t number : triangles) {
    for (const std::int32_t start : topology.triangles[number].vertices) {
      auto at = leaving.find(start);
      if (at == leaving.end()) continue;
      auto& loop = loops.emplace_back();
      while (at != leaving.end()) {
        loop.push_back(at->second);
        const std::int32_t following = next[at->first];
        leaving.erase(at);
        at = leaving.find(following);
      }
      // A smooth edge needs both its ends.
      std::vector<char> needed(loop.size(), 0);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        if (loop[i].kept) needed[i] = needed[(i + 1) % loop.size()] = 1;
      }
      for (std::size_t i = 0; i < loop.size(); ++i) loop[i].kept = needed[i] != 0;
    }
  }
  return loops;
}

}  // namespace

std::vector<CoplanarRegion> find_coplanar_regions(const MeshTopology& topology, const std::vector<char>& taken) {
  std::vector<std::int32_t> order(topology.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return topology.triangles[a].area > topology.triangles[b].area;
  });
  std::vector<std::int32_t> region(topology.triangles.size(), kNone);
  std::vector<CoplanarRegion> regions;
  std::int32_t number = 0;
  for (const std::int32_t first : order) {
    if (taken[first] || region[first] != kNone) continue;
    const Seed seed(topology, first);
    std::vector<std::int32_t> members{first};
    region[first] = number;
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (const std::int32_t neighbor : topology.triangles[members[i]].neighbors) {
        if (neighbor < 0 || taken[neighbor] || region[neighbor] != kNone || !seed.takes(neighbor)) continue;
        region[neighbor] = number;
        members.push_back(neighbor);
      }
    }
    ++number;
    if (members.size() < 3) continue;
    std::sort(members.begin(), members.end());
    CoplanarRegion& found = regions.emplace_back();
    found.loops = boundary_loops(topology, members, region);
    found.triangles = std::move(members);
    found.normal = seed.normal;
    found.tolerance = seed.tolerance;
  }
  return regions;
}

}  // namespace patchlight
