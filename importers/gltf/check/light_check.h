#pragma once
#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks the lights of KHR_lights_punctual: types, signs and angles. One of an unknown type counts as none, and is
/// noted. Throws: Error (bad_data) naming the place.
std::vector<GltfLight> checked_lights(GltfLists& gltf);

/// The lights that nodes have, by node. Throws: Error (bad_data) for an index out of range.
std::map<int, int> checked_node_lights(const GltfLists& gltf, const std::vector<GltfLight>& lights);

}  // namespace patchlight
