#include "solver/display/facets/facet_vertex_placer.h"

#include <algorithm>
#include <array>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

namespace {

// Distances of vertices from edges, where surfaces may meet, in (u,v). The larger ones are for corners that touch
// something small beside the facet, which must not darken all of it.
constexpr std::array<float, 3> kNudges{0.02f, 0.1f, 0.25f};
constexpr float kCovered = 0.5f;  // fraction of lit rays below which a vertex is covered
// Fractions of rays that go farther than half the length of the largest facet: of an enclosed vertex, and of a free
// one.
constexpr float kEnclosed = 0.1f, kFree = 0.4f;

}  // namespace

PlacedVertex FacetVertexPlacer::place(std::span<const FacetGraph::Corner> corners, std::uint64_t random,
                                      int& rays) const {
  std::vector<FacetGraph::Corner> largest_first(corners.begin(), corners.end());
  std::stable_sort(largest_first.begin(), largest_first.end(),
                   [&](const auto& a, const auto& b) { return size_of(a.primitive) > size_of(b.primitive); });
  const float reach = 0.5f * size_of(largest_first[0].primitive);
  PlacedVertex best{vertex_at(largest_first[0], kNudges[0]), false, 0.0f};
  float openness = -1;
  for (const float nudge : kNudges)
    for (const FacetGraph::Corner& corner : largest_first) {
      const DisplayMesh::Vertex vertex = vertex_at(corner, nudge);
      const View view = view_from(vertex, reach, random, rays);
      if (view.openness > openness) {
        best = {vertex, false, view.distance};
        openness = view.openness;
      }
      if (openness >= kFree) return best;
    }
  if (openness >= kEnclosed) return best;
  DisplayMesh::Vertex middle = best.vertex;
  middle.u = middle.v = 0.5f;
  best.covered = openness < 0 || view_from(middle, reach, random, rays).openness >= kFree;
  return best;
}

DisplayMesh::Vertex FacetVertexPlacer::vertex_at(const FacetGraph::Corner& corner, float nudge) const {
  const std::int32_t patch = patch_of_[corner.primitive];
  return {patch, corner.k % 2 ? 1 - nudge : nudge, corner.k / 2 ? 1 - nudge : nudge,
          corner.primitive - scene_.patches[patch].primitive};
}

/// The longer diagonal of a facet, m.
float FacetVertexPlacer::size_of(std::int32_t primitive) const {
  const auto& c = scene_.primitives[primitive].corners;
  return float(std::max((c[2] - c[0]).length(), (c[3] - c[1]).length()));
}

/// `reach`: distance of what is far, m.
FacetVertexPlacer::View FacetVertexPlacer::view_from(const DisplayMesh::Vertex& vertex, float reach,
                                                     std::uint64_t random, int& rays) const {
  const std::int32_t i = scene_.patches[vertex.patch].primitive + vertex.facet;
  SurfacePoint point = point_at(scene_.primitives[i], vertex.u, vertex.v);
  point.normal = normals_(i, vertex.u, vertex.v, point.normal);
  if (lit_ray_fraction(scene_, ray_scene_, i, point, random, rays) < kCovered) return {-1, 0};
  const PointDistances distances = distances_from(ray_scene_, i, point, reach, random, rays);
  return {distances.far, distances.harmonic_mean};
}

}  // namespace patchlight
