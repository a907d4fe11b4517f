#pragma once
#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks and reads the lights of KHR_lights_punctual. Warns of unknown types.
/// Throws: Error (bad_data) naming the light.
std::vector<GltfLight> checked_lights(GltfLists& gltf);

/// Indices into `lights` by node; without lights of unknown types. Throws: Error (bad_data) for an index out of range.
std::map<int, int> checked_node_lights(const GltfLists& gltf, const std::vector<GltfLight>& lights);

/// Sizes in the extras of the nodes in `node_lights` and of their parents. `parents`: by node; -1: a root.
std::map<int, GltfLightExtras> checked_light_extras(const GltfLists& gltf, const std::map<int, int>& node_lights,
                                                    const std::vector<int>& parents);

}  // namespace patchlight
