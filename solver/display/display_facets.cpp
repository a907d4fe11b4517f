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
constexpr float kNudge = 0.02f;   // in (u,v): distance of vertices from edges, where surfaces may meet
constexpr float kCovered = 0.5f;  // fraction of lit rays below which a vertex is covered
// Fractions of rays that go farther than half the facet's length: of an enclosed vertex, and of the middle of its
// facet.
constexpr float kEnclosed = 0.1f, kFree = 0.4f;

bool is_one_patch(const PatchLookup& lookup, std::int32_t primitive) {
  return lookup.rows(primitive) == 1 && lookup.row(primitive, 0).cells == 1;
}

/// Adds vertices at the corners of near facets. Returns their numbers by smooth vertex; -1: none.
std::vector<std::int32_t> add_vertices(const PatchSet& scene, const PatchLookup& lookup,
                                       std::span<const std::int32_t> near_patches,
                                       std::vector<DisplayMesh::Vertex>& vertices) {
  std::vector<std::int32_t> number;
  for (const std::int32_t patch : near_patches) {
    const Primitive& primitive = scene.primitives[scene.patches[patch].primitive];
    if (!is_one_patch(lookup, scene.patches[patch].primitive)) continue;
    for (int k = 0; k < 4; ++k) {
      const auto id = std::size_t(primitive.smooth_vertices[kCornerOf[k]]);
      if (id >= number.size()) number.resize(id + 1, -1);
      if (number[id] >= 0) continue;
      number[id] = std::int32_t(vertices.size());
      vertices.push_back({patch, k % 2 ? 1 - kNudge : kNudge, k / 2 ? 1 - kNudge : kNudge});
    }
  }
  return number;
}

/// Whether a vertex of a facet lies in another body, double-sided as it may be, of which the facet's middle is free.
bool is_enclosed(const PatchSet& scene, const RayScene& ray_scene, const DisplayMesh::Vertex& vertex,
                 const SurfacePoint& point, std::uint64_t random, int& rays) {
  const std::int32_t i = scene.patches[vertex.patch].primitive;
  const auto& c = scene.primitives[i].corners;
  const auto reach = float(0.5 * std::max((c[2] - c[0]).length(), (c[3] - c[1]).length()));
  if (far_ray_fraction(ray_scene, i, point, reach, random, rays) >= kEnclosed) return false;
  const SurfacePoint middle = point_at(scene.primitives[i], 0.5, 0.5);
  return far_ray_fraction(ray_scene, i, middle, reach, random, rays) > kFree;
}

std::vector<bool> covered(const PatchSet& scene, const RayScene& ray_scene,
                          std::span<const DisplayMesh::Vertex> vertices, std::int64_t& cast) {
  const SmoothNormals normals(scene);
  std::vector<std::uint8_t> is_covered(vertices.size());
  std::atomic<std::int64_t> all_rays{0};
  tbb::parallel_for(std::size_t(0), vertices.size(), [&](std::size_t k) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    const DisplayMesh::Vertex& vertex = vertices[k];
    const std::int32_t primitive = scene.patches[vertex.patch].primitive;
    SurfacePoint point = point_at(scene.primitives[primitive], vertex.u, vertex.v);
    point.normal = normals(primitive, vertex.u, vertex.v, point.normal);
    int rays = 0;
    is_covered[k] = lit_ray_fraction(scene, ray_scene, primitive, point, hash64(k), rays) < kCovered ||
                    is_enclosed(scene, ray_scene, vertex, point, hash64(k), rays);
    all_rays += rays;
  });
  cast += all_rays;
  return {is_covered.begin(), is_covered.end()};
}

}  // namespace

void add_display_facets(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                        std::span<const std::int32_t> near_patches, DisplayMesh& mesh, std::int64_t& cast) {
  std::vector<DisplayMesh::Vertex> vertices;
  const std::vector<std::int32_t> number = add_vertices(scene, lookup, near_patches, vertices);
  if (vertices.empty()) return;
  const std::vector<bool> is_covered = covered(scene, ray_scene, vertices, cast);
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
      if (vertex >= 0 && !is_covered[vertex]) open = facet.corners[k];
    }
    for (std::int32_t& corner : facet.corners)
      if (corner >= 0 && is_covered[corner - mesh.gathered]) corner = open;
    if (*std::max_element(facet.corners.begin(), facet.corners.end()) >= 0) mesh.facets.push_back(facet);
  }
  const auto count = std::int32_t(vertices.size());
  const auto shift_index = [&](std::int32_t& vertex) { vertex += vertex >= mesh.gathered ? count : 0; };
  std::for_each(mesh.corners.begin(), mesh.corners.end(), shift_index);
  for (auto& pair : mesh.midpoints) std::for_each(pair.begin(), pair.end(), shift_index);
  mesh.vertices.insert(mesh.vertices.begin() + mesh.gathered, vertices.begin(), vertices.end());
  mesh.gathered += count;
}

}  // namespace patchlight
