#include "solver/display/display_facets.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/smooth_normals.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

namespace {

constexpr std::array<int, 4> kCornerOf{0, 1, 3, 2};  // corners of a primitive, u first
// Distances of vertices from edges, where surfaces may meet, in (u,v). The larger ones are for corners that touch
// something small beside the facet, which must not darken all of it.
constexpr std::array<float, 3> kNudges{0.02f, 0.1f, 0.25f};
constexpr float kCovered = 0.5f;  // fraction of lit rays below which a vertex is covered
// Fractions of rays that go farther than half the length of the largest facet: of an enclosed vertex, and of a free
// one.
constexpr float kEnclosed = 0.1f, kFree = 0.4f;

bool is_one_patch(const PatchLookup& lookup, std::int32_t primitive) {
  return lookup.rows(primitive) == 1 && lookup.row(primitive, 0).cells == 1;
}

/// A corner of a facet, where a vertex may lie.
struct Corner {
  std::int32_t patch;
  int k;  ///< In rows of growing u.

  DisplayMesh::Vertex vertex(float nudge) const {
    return {patch, k % 2 ? 1 - nudge : nudge, k / 2 ? 1 - nudge : nudge};
  }
};

/// Finds the corners of near facets, `corners` [vertices]. Returns the vertices' numbers by smooth vertex; -1: none.
std::vector<std::int32_t> find_corners(const PatchSet& scene, const PatchLookup& lookup,
                                       std::span<const std::int32_t> near_patches,
                                       std::vector<std::vector<Corner>>& corners) {
  std::vector<std::int32_t> number;
  for (const std::int32_t patch : near_patches) {
    const Primitive& primitive = scene.primitives[scene.patches[patch].primitive];
    if (!is_one_patch(lookup, scene.patches[patch].primitive)) continue;
    for (int k = 0; k < 4; ++k) {
      const auto id = std::size_t(primitive.smooth_vertices[kCornerOf[k]]);
      if (id >= number.size()) number.resize(id + 1, -1);
      if (number[id] < 0) {
        number[id] = std::int32_t(corners.size());
        corners.emplace_back();
      }
      corners[number[id]].push_back({patch, k});
    }
  }
  return number;
}

/// Places vertices of facets.
class VertexPlacer {
 public:
  VertexPlacer(const PatchSet& scene, const RayScene& ray_scene)
      : scene_(scene), ray_scene_(ray_scene), normals_(scene) {}

  /// The vertex at the first of some corners, the largest facet's first, that nothing encloses, or else at the most
  /// open one; and whether it is covered: in another body, double-sided as it may be, of which its facet's middle is
  /// free.
  std::pair<DisplayMesh::Vertex, bool> place(std::vector<Corner> corners, std::uint64_t random, int& rays) const {
    const auto size = [&](const Corner& corner) { return size_of(corner.patch); };
    std::stable_sort(corners.begin(), corners.end(), [&](auto& a, auto& b) { return size(a) > size(b); });
    const float reach = 0.5f * size(corners[0]);
    DisplayMesh::Vertex best = corners[0].vertex(kNudges[0]);
    float openness = -1;
    for (const float nudge : kNudges)
      for (const Corner& corner : corners) {
        const DisplayMesh::Vertex vertex = corner.vertex(nudge);
        const float of_vertex = openness_at(vertex, reach, random, rays);
        if (of_vertex > openness) {
          best = vertex;
          openness = of_vertex;
        }
        if (openness >= kFree) return {best, false};
      }
    if (openness >= kEnclosed) return {best, false};
    return {best, openness < 0 || openness_at({best.patch, 0.5f, 0.5f}, reach, random, rays) >= kFree};
  }

 private:
  /// The longer diagonal of a patch's facet, m.
  float size_of(std::int32_t patch) const {
    const auto& c = scene_.primitives[scene_.patches[patch].primitive].corners;
    return float(std::max((c[2] - c[0]).length(), (c[3] - c[1]).length()));
  }

  /// Fraction of rays that go farther than `reach`, m; negative where most find unlit backs.
  float openness_at(const DisplayMesh::Vertex& vertex, float reach, std::uint64_t random, int& rays) const {
    const std::int32_t i = scene_.patches[vertex.patch].primitive;
    SurfacePoint point = point_at(scene_.primitives[i], vertex.u, vertex.v);
    point.normal = normals_(i, vertex.u, vertex.v, point.normal);
    if (lit_ray_fraction(scene_, ray_scene_, i, point, random, rays) < kCovered) return -1;
    return far_ray_fraction(ray_scene_, i, point, reach, random, rays);
  }

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const SmoothNormals normals_;
};

/// The vertices at some corners [vertices], and whether they are covered.
std::vector<std::pair<DisplayMesh::Vertex, bool>> place_vertices(const PatchSet& scene, const RayScene& ray_scene,
                                                                 const std::vector<std::vector<Corner>>& corners,
                                                                 std::int64_t& cast) {
  const VertexPlacer placer(scene, ray_scene);
  std::vector<std::pair<DisplayMesh::Vertex, bool>> vertices(corners.size());
  std::atomic<std::int64_t> all_rays{0};
  tbb::parallel_for(std::size_t(0), corners.size(), [&](std::size_t k) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    int rays = 0;
    vertices[k] = placer.place(corners[k], hash64(k), rays);
    all_rays += rays;
  });
  cast += all_rays;
  return vertices;
}

}  // namespace

void add_display_facets(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                        std::span<const std::int32_t> near_patches, DisplayMesh& mesh, std::int64_t& cast) {
  std::vector<std::vector<Corner>> corners;
  const std::vector<std::int32_t> number = find_corners(scene, lookup, near_patches, corners);
  if (corners.empty()) return;
  const auto vertices = place_vertices(scene, ray_scene, corners, cast);
  const auto is_covered = [&](std::int32_t vertex) { return vertices[vertex].second; };
  for (std::int32_t i = 0; i < std::int32_t(scene.patches.size()); ++i) {
    const Primitive& primitive = scene.primitives[scene.patches[i].primitive];
    if (primitive.shape != Primitive::Shape::quad || primitive.smooth_vertices[0] < 0) continue;
    if (!is_one_patch(lookup, scene.patches[i].primitive) || mesh.roots[i] >= 0) continue;
    DisplayMesh::Facet facet{i};
    std::int32_t open = -1;
    for (int k = 0; k < 4; ++k) {
      const auto id = std::size_t(primitive.smooth_vertices[kCornerOf[k]]);
      const std::int32_t vertex = id < number.size() ? number[id] : -1;
      facet.corners[k] = vertex >= 0 ? vertex + mesh.gathered : -1;
      if (vertex >= 0 && !is_covered(vertex)) open = facet.corners[k];
    }
    for (std::int32_t& corner : facet.corners)
      if (corner >= 0 && is_covered(corner - mesh.gathered)) corner = open;
    if (*std::max_element(facet.corners.begin(), facet.corners.end()) >= 0) mesh.facets.push_back(facet);
  }
  const auto count = std::int32_t(vertices.size());
  const auto shift_index = [&](std::int32_t& vertex) { vertex += vertex >= mesh.gathered ? count : 0; };
  std::for_each(mesh.corners.begin(), mesh.corners.end(), shift_index);
  for (auto& pair : mesh.midpoints) std::for_each(pair.begin(), pair.end(), shift_index);
  std::vector<DisplayMesh::Vertex> gathered;
  for (const auto& [vertex, covered] : vertices) gathered.push_back(vertex);
  mesh.vertices.insert(mesh.vertices.begin() + mesh.gathered, gathered.begin(), gathered.end());
  mesh.gathered += count;
}

}  // namespace patchlight
