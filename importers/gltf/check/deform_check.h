#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks EXT_mesh_gpu_instancing: attributes have permitted types, a bufferView and equal counts. Returns the
/// instances by node. Throws: Error (bad_data) naming the element.
std::map<int, GltfInstances> checked_instances(const GltfLists& gltf);

/// Checks that the joints of skins are nodes and that there is a matrix for each joint.
/// Throws: Error (bad_data) naming the skin.
void check_skins(const GltfLists& gltf);

}  // namespace patchlight
