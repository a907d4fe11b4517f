#include "pipeline/model/display_mesh.h"

#include <algorithm>

namespace patchlight {

bool fits(const DisplayMesh& mesh, const PatchSet& scene) {
  const auto is_there = [&](const auto& place) { return place.facet < std::max(1, scene.patches[place.patch].facets); };
  return mesh.roots.size() == scene.patches.size() &&
         std::all_of(mesh.vertices.begin(), mesh.vertices.end(), is_there) &&
         std::all_of(mesh.facets.begin(), mesh.facets.end(), is_there);
}

}  // namespace patchlight
