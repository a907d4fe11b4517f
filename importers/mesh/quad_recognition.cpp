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

constexpr double kPlaneTolerance = 1e-4;     // distance of a corner from the other triangle's plane / longest edge
constexpr double kMaxSliverFoldSine = 1e-2;  // needed for slivers, whose corners lie near every plane through them
constexpr double kQuantizedFoldSine = 2e-2;  // where rounding of positions exceeds kPlaneTolerance
constexpr double kMinCornerSine = 1e-3;
constexpr float kNormalStep = 0.02f;  // between the file's normals of two triangles where they meet
constexpr double kScoreStep = 1e-5;   // rectangles score equally in spite of rounding

constexpr std::int32_t kNone = -1;

using Triangle = MeshTopology::Triangle;

/// Two triangles as a quad. Their shared edge runs between corners 0 and 2.
struct TrianglePair {
  std::int64_t score = 0;  ///< Largest |cosine| of a corner, in kScoreStep; 0 for a rectangle.
  std::int32_t first = 0;
  std::int32_t second = 0;
  Facet quad;

  auto order() const { return std::tie(score, first, second); }
};

/// Whether the triangles of a quad are coplanar. `rounding`: error of positions, m. `flat`: their normals agree, so
/// that any fold may be due to rounding.
bool coplanar(const Triangle& a, const Triangle& b, const std::array<Vec3d, 4>& quad, double rounding, bool flat) {
  if (a.normal.dot(b.normal) <= 0.0) return false;
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) longest = std::max(longest, (quad[(i + 1) % 4] - quad[i]).length());
  longest = std::max(longest, (quad[2] - quad[0]).length());
  const double apex_of_b = std::abs(a.normal.dot(quad[1] - quad[0]));
  const double apex_of_a = std::abs(b.normal.dot(quad[3] - quad[0]));
  const double farthest = std::max(apex_of_a, apex_of_b);
  const double fold = a.normal.cross(b.normal).length();
  if (fold <= kMaxSliverFoldSine && farthest <= kPlaneTolerance * longest) return true;
  return farthest <= 2.0 * rounding && (flat || fold <= kQuantizedFoldSine);
}

/// The largest |cosine| of a corner; nothing if the quad is not convex.
std::optional<double> max_corner_cosine(const std::array<Vec3d, 4>& quad, const Vec3d& normal) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d in = (quad[(i + 1) % 4] - quad[i]).normalized();
    const Vec3d out = (quad[(i + 2) % 4] - quad[(i + 1) % 4]).normalized();
    if (!(in.cross(out).dot(normal) > kMinCornerSine)) return std::nullopt;
    worst = std::max(worst, std::abs(in.dot(out)));
  }
  return worst;
}

/// Permitted difference between a corner's value and that of the affine map: the sum of three terms.
struct AffineTolerance {
  double extent = 0.0;    ///< Times the extent of the values over the quad.
  double relative = 0.0;  ///< Times the largest value.
  double absolute = 0.0;
};
constexpr AffineTolerance kColorTolerance{0.0, 0.0, 1.0 / 512};

bool is_missing(const Vec2f& texcoord) {
  return std::isnan(texcoord.x);
}
bool is_missing(const Vec4f&) {
  return false;
}

/// Whether one affine map gives the values at all corners: the map of triangle 0, 2, 3 also at corner 1. `first_end`
/// and `second_end` are the other triangle's values at corners 0 and 2, which must agree.
template <class Value>
bool is_affine(const std::array<Vec3d, 4>& c, const std::array<Value, 4>& values, const Value& first_end,
               const Value& second_end, const AffineTolerance& tolerance) {
  using Wide = std::conditional_t<std::is_same_v<Value, Vec2f>, Imath::V2d, Imath::V4d>;
  std::array<Wide, 4> t;
  double largest = 0.0;
  double extent = 0.0;
  int missing = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    t[i] = Wide(values[i]);
    missing += is_missing(values[i]) ? 1 : 0;
    largest = std::max(largest, t[i].length());
    extent = std::max(extent, (t[i] - t[0]).length());
  }
  if (missing == 4) return true;
  const Vec3d edge1 = c[2] - c[0];
  const Vec3d edge2 = c[3] - c[0];
  const Vec3d to = c[1] - c[0];
  const Vec3d normal = edge1.cross(edge2);
  const double a = to.cross(edge2).dot(normal) / normal.length2();
  const double b = edge1.cross(to).dot(normal) / normal.length2();
  const Wide expected = t[0] + (t[2] - t[0]) * a + (t[3] - t[0]) * b;
  const double max_difference = tolerance.extent * extent + tolerance.relative * largest + tolerance.absolute;
  return (t[1] - expected).length() <= max_difference && (Wide(first_end) - t[0]).length() <= max_difference &&
         (Wide(second_end) - t[2]).length() <= max_difference;
}

/// The quad of a triangle and its neighbour across `edge`; nothing unless it is planar, convex and affinely mapped.
std::optional<TrianglePair> merged_pair(const MeshTopology& topology, std::int32_t first, int edge) {
  const Triangle& a = topology.triangles[first];
  const std::int32_t second = a.neighbors[edge];
  const Triangle& b = topology.triangles[second];
  const int end = (edge + 1) % 3;
  const int apex_of_a = (edge + 2) % 3;
  // The shared edge runs the other way in b, so the corner after its start in a is b's apex.
  const auto start_in_b = std::find(b.vertices.begin(), b.vertices.end(), a.vertices[edge]) - b.vertices.begin();
  const auto apex_of_b = static_cast<std::size_t>(start_in_b + 1) % 3;

  TrianglePair pair;
  pair.first = first;
  pair.second = second;
  const std::array<std::int32_t, 4> vertices{a.vertices[edge], b.vertices[apex_of_b], a.vertices[end],
                                             a.vertices[apex_of_a]};
  for (std::size_t i = 0; i < 4; ++i) pair.quad.corners[i] = topology.vertices[vertices[i]];
  pair.quad.smooth_vertices = {a.smooth_vertices[edge], b.smooth_vertices[apex_of_b], a.smooth_vertices[end],
                               a.smooth_vertices[apex_of_a]};
  if (!coplanar(a, b, pair.quad.corners, topology.rounding, flat_by_normals(topology, first, second)))
    return std::nullopt;
  const auto corner = [](std::int32_t triangle, std::ptrdiff_t index) {
    return CornerSource{3 * triangle + static_cast<std::int32_t>(index)};
  };
  pair.quad.sources = {corner(first, edge), corner(second, static_cast<std::ptrdiff_t>(apex_of_b)), corner(first, end),
                       corner(first, apex_of_a)};
  const CornerSource first_end = corner(second, start_in_b);
  const CornerSource second_end = corner(second, static_cast<std::ptrdiff_t>(apex_of_b + 1) % 3);
  const auto agree = [&](const auto& values, const AffineTolerance& tolerance) {
    const auto& s = pair.quad.sources;
    return is_affine(pair.quad.corners, std::array{s[0](values), s[1](values), s[2](values), s[3](values)},
                     first_end(values), second_end(values), tolerance);
  };
  for (const auto& [a_end, b_end] : {std::pair(pair.quad.sources[0], first_end), {pair.quad.sources[2], second_end}})
    if ((a_end(topology.normals) - b_end(topology.normals)).length() > kNormalStep) return std::nullopt;
  const AffineTolerance tolerance{1e-5, 1e-6, 2.0 * topology.texcoord_rounding};
  for (const auto& texcoords : topology.texcoords)
    if (!agree(texcoords, tolerance)) return std::nullopt;
  if (!topology.colors.empty() && !agree(topology.colors, kColorTolerance)) return std::nullopt;
  const std::optional<double> score = max_corner_cosine(pair.quad.corners, a.normal);
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

/// All possible pairs, best score first. `pair_of`: by triangle, the index of the pair chosen for it, or kNone.
std::vector<TrianglePair> match_triangle_pairs(const MeshTopology& topology, const std::vector<char>& excluded,
                                               std::vector<std::int32_t>& pair_of) {
  std::vector<TrianglePair> triangle_pairs;
  const auto count = static_cast<std::int32_t>(topology.triangles.size());
  for (std::int32_t first = 0; first < count; ++first) {
    if (excluded[first]) continue;
    for (int edge = 0; edge < 3; ++edge) {
      const std::int32_t second = topology.triangles[first].neighbors[edge];
      if (second <= first || excluded[second]) continue;
      if (const auto pair = merged_pair(topology, first, edge)) triangle_pairs.push_back(*pair);
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

/// Number of facets that a region becomes by pairing triangles.
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

RecognizedFacets recognize_quads(const MeshTopology& topology, std::vector<char> excluded, bool as_regions) {
  std::vector<std::int32_t> pair_of;
  std::vector<TrianglePair> triangle_pairs = match_triangle_pairs(topology, excluded, pair_of);
  RecognizedFacets result;
  result.smooth_vertices = static_cast<std::int32_t>(3 * topology.triangles.size());
  std::map<std::int32_t, std::vector<Facet>> merged;  // by the region's first triangle
  for (const CoplanarRegion& region : find_coplanar_regions(topology, excluded)) {
    const std::size_t max_facets = facet_count(region, triangle_pairs, pair_of) - 1;
    std::vector<Facet> quads = region_quads(topology, region, max_facets, as_regions, result.smooth_vertices);
    if (quads.empty()) continue;
    for (const std::int32_t triangle : region.triangles) excluded[triangle] = 1;
    result.merged_triangles += region.triangles.size();
    result.merged_facets += quads.size();
    merged.emplace(region.triangles.front(), std::move(quads));
  }
  if (!merged.empty()) triangle_pairs = match_triangle_pairs(topology, excluded, pair_of);

  for (std::int32_t t = 0; t < static_cast<std::int32_t>(topology.triangles.size()); ++t) {
    const auto quads = merged.find(t);
    if (quads != merged.end()) {
      result.facets.insert(result.facets.end(), quads->second.begin(), quads->second.end());
    } else if (excluded[t]) {
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
