#include "solver/display/facets/display_facets.h"

#include <algorithm>
#include <vector>

#include "solver/display/facets/facet_graph.h"
#include "solver/display/facets/facet_vertices.h"

namespace patchlight {

namespace {

/// A primitive that is not divided and may have irradiance at its corners.
struct Facet {
  std::int32_t primitive, patch;
};

/// All facets of a scene whose patches the mesh does not divide.
std::vector<Facet> find_facets(const PatchSet& scene, const PatchLookup& lookup, const DisplayMesh& mesh) {
  std::vector<Facet> facets;
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape != Primitive::Shape::quad || p.smooth_vertices[0] < 0) continue;
    if (lookup.rows(i) != 1 || lookup.row(i, 0).cells != 1) continue;
    const std::int32_t patch = lookup.nearest(lookup.row(i, 0), 0);
    if (mesh.roots[patch] < 0) facets.push_back({i, patch});
  }
  return facets;
}

/// Inserts vertices into the mesh behind its last gathering vertex, and renumbers the others.
void add_vertices(const std::vector<DisplayMesh::Vertex>& vertices, DisplayMesh& mesh) {
  const auto count = std::int32_t(vertices.size());
  const auto shift_index = [&](std::int32_t& vertex) { vertex += vertex >= mesh.gathered ? count : 0; };
  std::for_each(mesh.corners.begin(), mesh.corners.end(), shift_index);
  for (auto& pair : mesh.midpoints) std::for_each(pair.begin(), pair.end(), shift_index);
  mesh.vertices.insert(mesh.vertices.begin() + mesh.gathered, vertices.begin(), vertices.end());
  mesh.gathered += count;
}

}  // namespace

void add_display_facets(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                        std::span<const std::int32_t> near_patches, DisplayMesh& mesh, std::int64_t& cast) {
  std::vector<bool> has_vertices(scene.patches.size());
  for (const std::int32_t patch : near_patches) has_vertices[patch] = true;
  const std::vector<Facet> facets = find_facets(scene, lookup, mesh);
  std::vector<std::int32_t> of_graph, patch_of(scene.primitives.size(), -1);
  for (const auto& [i, patch] : facets) {
    patch_of[i] = patch;
    if (has_vertices[patch] || scene.patches[patch].facets > 0) of_graph.push_back(i);
  }
  if (of_graph.empty()) return;
  const FacetGraph graph = facet_graph(scene, of_graph);
  FacetVertices chosen = choose_facet_vertices(scene, ray_scene, graph, patch_of, cast);
  const auto count = std::int32_t(chosen.vertices.size()), first = mesh.gathered;
  const std::int32_t first_blend = std::int32_t(mesh.vertices.size()) + count;
  for (const auto& [i, patch] : facets) {
    DisplayMesh::Facet facet{patch, {}, i - scene.patches[patch].primitive};
    std::int32_t other = -1;  // for corners that are enclosed
    std::array<bool, 4> enclosed{};
    for (int k = 0; k < 4; ++k) {
      const std::int32_t node = graph.at(scene.primitives[i].smooth_vertices[kCornersInRows[k]]);
      const std::int32_t chosen_at = node < 0 ? FacetVertices::kNone : chosen.of_node[node];
      enclosed[k] = node >= 0 && chosen_at < 0;
      facet.corners[k] = chosen_at < 0 ? -1 : chosen_at + (chosen_at < count ? first : first_blend - count);
      other = std::max(other, facet.corners[k]);
    }
    if (other < 0) continue;
    for (int k = 0; k < 4; ++k)
      if (enclosed[k]) facet.corners[k] = other;
    mesh.facets.push_back(facet);
  }
  add_vertices(chosen.vertices, mesh);
  for (DisplayMesh::Part& part : chosen.blended) part.vertex += first;
  mesh.blends = std::move(chosen.blends);
  mesh.blended = std::move(chosen.blended);
}

}  // namespace patchlight
