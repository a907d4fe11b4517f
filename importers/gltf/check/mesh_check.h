#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <set>

#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks the meshes: indices are in range, and attributes have equal counts and types that glTF, or
/// KHR_mesh_quantization if the file uses it, permits. Only these texture coordinate sets are checked. Expects checked
/// accessors. Throws: Error (bad_data) naming the element.
void check_meshes(GltfLists& gltf, const std::set<int>& texcoord_sets);

}  // namespace patchlight
