#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// A node's instances by EXT_mesh_gpu_instancing, checked: their attributes have types that it allows, bytes, and equal
/// counts. Nothing for a node without. Throws: Error (bad_data) naming the place.
std::map<int, GltfInstances> checked_instances(const GltfLists& gltf);

/// Checks skins: their joints are nodes, their matrices as many. Throws: Error (bad_data) naming the skin.
void check_skins(const GltfLists& gltf);

}  // namespace patchlight
