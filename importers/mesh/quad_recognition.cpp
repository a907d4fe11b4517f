#include "importers/mesh/quad_recognition.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <type_traits>

#include "importers/mesh/coplanar_regions.h"
#include "importers/mesh/region_quads.h"

namespace patchlight {
namespace {

constexpr double kFlatness = 1e-4;         // distance of a corner from the other triangle's plane, in longest edges
constexpr double kLargestFoldSine = 1e-2;  // also for slivers, whose corners are never far from any plane
constexpr double kRoundedFoldSine = 2e-2;  // where places are rounded to more than that flatness
constexpr double kLeastCornerSine = 1e-3;
constexpr double kScoreStep = 1e-5;  // rectangles are equally good up to rounding

constexpr std::int32_t kNone = -1;

using Triangle = MeshTopology::Triangle;

/// Two triangles as a quad. Corners 0 and 2 are the ends of the edge that they share.
struct TrianglePair {
  std::int64_t score = 0;  ///< 0 for a rectangle; the cosine of the corner farthest from a right angle.
  std::int32_t first = 0;
  std::int32_t second = 0;
  Facet quad;

  auto order() const { return std::tie(score, first, second); }
};

/// Whether the triangles of a quad lie in one plane, but for `rounding`; of those that are `flat` in the file rounding
/// may be all that folds them.
bool coplanar(const Triangle& a, const Triangle& b, const std::array<Vec3d, 4>& quad, double rounding, bool flat) {
  if (a.normal.dot(b.normal) <= 0.0) return false;
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) longest = std::max(longest, (quad[(i + 1) % 4] - quad[i]).length());
  longest = std::max(longest, (quad[2] - quad[0]).length());
  const double apex_of_b = std::abs(a.normal.dot(quad[1] - quad[0]));
  const double apex_of_a = std::abs(b.normal.dot(quad[3] - quad[0]));
  const double farthest = std::max(apex_of_a, apex_of_b);
  const double fold = a.normal.cross(b.normal).length();
  if (fold <= kLargestFoldSine && farthest <= kFlatness * longest) return true;
  return farthest <= 2.0 * rounding && (flat || fold <= kRoundedFoldSine);
}

/// The largest cosine of a corner; nothing unless all corners turn left.
std::optional<double> farthest_from_rectangle(const std::array<Vec3d, 4>& quad, const Vec3d& normal) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d in = (quad[(i + 1) % 4] - quad[i]).normalized();
    const Vec3d out = (quad[(i + 2) % 4] - quad[(i + 1) % 4]).normalized();
    if (!(in.cross(out).dot(normal) > kLeastCornerSine)) return std::nullopt;
    worst = std::max(worst, std::abs(in.dot(out)));
  }
  return worst;
}

/// How closely values at corners have to be mapped as one: in their extent over the quad, in the largest of them, and
/// at all.
struct MappingTolerance {
  double extent = 0.0;
  double relative = 0.0;
  double absolute = 0.0;
};
constexpr MappingTolerance kColorTolerance{0.0, 0.0, 1.0 / 512};

bool is_absent(const Vec2f& texcoord) {
  return std::isnan(texcoord.x);
}
bool is_absent(const Vec4f&) {
  return false;
}

/// Whether the map of values of the triangle of corners 0, 2, 3 also holds at corner 1, and whether the other triangle
/// agrees: `first_end` and `second_end` are what it has at corners 0 and 2.
template <class Value>
bool mapped_as_one(const std::array<Vec3d, 4>& c, const std::array<Value, 4>& values, const Value& first_end,
                   const Value& second_end, const MappingTolerance& tolerance) {
  using Wide = std::conditional_t<std::is_same_v<Value, Vec2f>, Imath::V2d, Imath::V4d>;
  std::array<Wide, 4> t;
  double largest = 0.0;
  double extent = 0.0;
  int without = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    t[i] = Wide(values[i]);
    without += is_absent(values[i]) ? 1 : 0;
    largest = std::max(largest, t[i].length());
    extent = std::max(extent, (t[i] - t[0]).length());
  }
  if (without == 4) return true;
  const Vec3d along = c[2] - c[0];
  const Vec3d up = c[3] - c[0];
  const Vec3d to = c[1] - c[0];
  const Vec3d normal = along.cross(up);
  const double a = to.cross(up).dot(normal) / normal.length2();
  const double b = along.cross(to).dot(normal) / normal.length2();
  const Wide expected = t[0] + (t[2] - t[0]) * a + (t[3] - t[0]) * b;
  const double most = tolerance.extent * extent + tolerance.relative * largest + tolerance.absolute;
  return (t[1] - expected).length() <= most && (Wide(first_end) - t[0]).length() <= most &&
         (Wide(second_end) - t[2]).length() <= most;
}

std::optional<TrianglePair> paired(const MeshTopology& topology, std::int32_t first, int edge) {
  const Triangle& a = topology.triangles[first];
  const std::int32_t second = a.neighbors[edge];
  const Triangle& b = topology.triangles[second];
  const int end = (edge + 1) % 3;
  const int rest = (edge + 2) % 3;
  // b runs through the shared edge the other way; its third corner lies between the edge's ends.
  const auto start_in_b = std::find(b.vertices.begin(), b.vertices.end(), a.vertices[edge]) - b.vertices.begin();
  const auto apex = static_cast<std::size_t>(start_in_b + 1) % 3;

  TrianglePair pair;
  pair.first = first;
  pair.second = second;
  const std::array<std::int32_t, 4> vertices{a.vertices[edge], b.vertices[apex], a.vertices[end], a.vertices[rest]};
  for (std::size_t i = 0; i < 4; ++i) pair.quad.corners[i] = topology.vertices[vertices[i]];
  pair.quad.smooth_vertices = {a.smooth_vertices[edge], b.smooth_vertices[apex], a.smooth_vertices[end],
                               a.smooth_vertices[rest]};
  if (!coplanar(a, b, pair.quad.corners, topology.rounding, flat_by_normals(topology, first, second)))
    return std::nullopt;
  const auto corner = [](std::int32_t triangle, std::ptrdiff_t index) {
    return CornerSource{3 * triangle + static_cast<std::int32_t>(index)};
  };
  pair.quad.sources = {corner(first, edge), corner(second, static_cast<std::ptrdiff_t>(apex)), corner(first, end),
                       corner(first, rest)};
  const CornerSource first_end = corner(second, start_in_b);
  const CornerSource second_end = corner(second, static_cast<std::ptrdiff_t>(apex + 1) % 3);
  const auto agree = [&](const auto& values, const MappingTolerance& tolerance) {
    const auto& s = pair.quad.sources;
    return mapped_as_one(pair.quad.corners, std::array{s[0](values), s[1](values), s[2](values), s[3](values)},
                         first_end(values), second_end(values), tolerance);
  };
  const MappingTolerance tolerance{1e-5, 1e-6, 2.0 * topology.texcoord_rounding};
  for (const auto& texcoords : topology.texcoords)
    if (!agree(texcoords, tolerance)) return std::nullopt;
  if (!topology.colors.empty() && !agree(topology.colors, kColorTolerance)) return std::nullopt;
  const std::optional<double> score = farthest_from_rectangle(pair.quad.corners, a.normal);
  if (!score) return std::nullopt;
  pair.score = std::llround(*score / kScoreStep);
  return pair;
}

Facet single_triangle(const MeshTopology& topology, std::int32_t index) {
  const Triangle& triangle = topology.triangles[index];
  std::size_t start = 0;
  double shortest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length =
        (topology.vertices[triangle.vertices[(i + 1) % 3]] - topology.vertices[triangle.vertices[i]]).length();
    if (i == 0 || length < shortest) {
      shortest = length;
      start = i;
    }
  }
  Facet facet;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t corner = (start + std::min<std::size_t>(i, 2)) % 3;
    facet.corners[i] = topology.vertices[triangle.vertices[corner]];
    facet.smooth_vertices[i] = triangle.smooth_vertices[corner];
    facet.sources[i].from = 3 * index + static_cast<std::int32_t>(corner);
  }
  return facet;
}

/// Pairs, the best first, and for each triangle the one that it goes into.
std::vector<TrianglePair> chosen_triangle_pairs(const MeshTopology& topology, const std::vector<char>& taken,
                                                std::vector<std::int32_t>& pair_of) {
  std::vector<TrianglePair> triangle_pairs;
  const auto count = static_cast<std::int32_t>(topology.triangles.size());
  for (std::int32_t first = 0; first < count; ++first) {
    if (taken[first]) continue;
    for (int edge = 0; edge < 3; ++edge) {
      const std::int32_t second = topology.triangles[first].neighbors[edge];
      if (second <= first || taken[second]) continue;
      if (const auto pair = paired(topology, first, edge)) triangle_pairs.push_back(*pair);
    }
  }
  std::sort(triangle_pairs.begin(), triangle_pairs.end(),
            [](const TrianglePair& a, const TrianglePair& b) { return a.order() < b.order(); });

  pair_of.assign(topology.triangles.size(), kNone);
  for (std::size_t i = 0; i < triangle_pairs.size(); ++i) {
    const TrianglePair& pair = triangle_pairs[i];
    if (pair_of[pair.first] != kNone || pair_of[pair.second] != kNone) continue;
    pair_of[pair.first] = pair_of[pair.second] = static_cast<std::int32_t>(i);
  }
  return triangle_pairs;
}

/// How many facets pairs make of a region.
std::size_t facet_count(const CoplanarRegion& region, const std::vector<TrianglePair>& triangle_pairs,
                        const std::vector<std::int32_t>& pair_of) {
  const auto& triangles = region.triangles;
  return static_cast<std::size_t>(std::count_if(triangles.begin(), triangles.end(), [&](std::int32_t triangle) {
    if (pair_of[triangle] == kNone) return true;
    const std::int32_t first = triangle_pairs[pair_of[triangle]].first;
    return first == triangle || !std::binary_search(triangles.begin(), triangles.end(), first);
  }));
}

}  // namespace

RecognizedFacets recognize_quads(const MeshTopology& topology, std::vector<char> taken) {
  std::vector<std::int32_t> pair_of;
  std::vector<TrianglePair> triangle_pairs = chosen_triangle_pairs(topology, taken, pair_of);
  RecognizedFacets result;
  result.smooth_vertices = static_cast<std::int32_t>(3 * topology.triangles.size());
  std::map<std::int32_t, std::vector<Facet>> merged;  // by their region's first triangle
  for (const CoplanarRegion& region : find_coplanar_regions(topology, taken)) {
    const std::size_t most = facet_count(region, triangle_pairs, pair_of) - 1;
    std::vector<Facet> quads = region_quads(topology, region, most, result.smooth_vertices);
    if (quads.empty()) continue;
    for (const std::int32_t triangle : region.triangles) taken[triangle] = 1;
    result.merged_triangles += region.triangles.size();
    result.merged_facets += quads.size();
    merged.emplace(region.triangles.front(), std::move(quads));
  }
  if (!merged.empty()) triangle_pairs = chosen_triangle_pairs(topology, taken, pair_of);

  for (std::int32_t t = 0; t < static_cast<std::int32_t>(topology.triangles.size()); ++t) {
    const auto quads = merged.find(t);
    if (quads != merged.end()) {
      result.facets.insert(result.facets.end(), quads->second.begin(), quads->second.end());
    } else if (taken[t]) {
      continue;
    } else if (pair_of[t] == kNone) {
      result.facets.push_back(single_triangle(topology, t));
    } else if (triangle_pairs[pair_of[t]].first == t) {
      result.facets.push_back(triangle_pairs[pair_of[t]].quad);
    }
  }
  return result;
}

}  // namespace patchlight
