#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include <set>

#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks the meshes: what they name, and that the accessors of what is read of them have types that glTF, or
/// KHR_mesh_quantization where the file uses it, allows, and equal counts. Of texture coordinates the sets that are
/// read. Expects accessors that are checked. Throws: Error (bad_data) naming the place.
void check_meshes(GltfLists& gltf, const std::set<int>& texcoord_sets);

}  // namespace patchlight
