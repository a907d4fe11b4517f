#include "importers/gltf/read/node_overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "importers/gltf/model/gltf_model.h"
#include "importers/gltf/read/materials.h"
#include "importers/gltf/read/name_pattern.h"

namespace patchlight {

bool is_excluded(const std::vector<MaterialOverride>& overrides, const std::string& name) {
  bool excluded = false;
  for (const MaterialOverride& change : overrides) {
    if (change.exclude && matches(change.pattern, name)) excluded = *change.exclude;
  }
  return excluded;
}

void remove_excluded(const GltfModel& model, const Job& job, GltfScene& scene) {
  const auto& materials = model.gltf.materials;
  std::erase_if(scene.surfaces, [&](const Surface& surface) {
    const auto number = static_cast<std::size_t>(surface.material);
    const std::string name = number < materials.size() ? materials[number].name : "";
    const bool excluded = is_excluded(job.materials, name.empty() ? "default" : name) ||
                          is_excluded(job.nodes, scene.nodes[surface.node]);
    if (excluded) scene.triangles -= model.mesh_parts[surface.mesh][surface.part].triangles;
    return excluded;
  });
}

void override_nodes(const GltfModel& model, const Job& job, GltfScene& scene, Progress& progress) {
  for (const MaterialOverride& change : job.nodes) {
    const bool found = std::any_of(scene.nodes.begin(), scene.nodes.end(),
                                   [&](const std::string& name) { return matches(change.pattern, name); });
    if (!found) progress.warning(fmt::format("nodes.{} in the job matches no node of the scene", change.pattern));
  }
  if (job.nodes.empty()) return;
  std::map<std::pair<int, int>, int> own;  // overridden material, by node and material
  for (Surface& surface : scene.surfaces) {
    const auto [entry, is_new] = own.emplace(std::pair(surface.node, surface.material), surface.material);
    if (is_new) {
      if (auto changed =
              node_material(model, job, scene.nodes[surface.node], scene.materials[surface.material], progress)) {
        entry->second = static_cast<int>(scene.materials.size());
        scene.materials.push_back(std::move(*changed));
      }
    }
    surface.material = entry->second;
  }
}

}  // namespace patchlight
