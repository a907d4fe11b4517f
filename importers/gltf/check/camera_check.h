#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <map>

#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks what `extras` of nodes with a camera say about its lens, and returns it by node.
/// Throws: Error (bad_data) for a value that is no number or out of range, and an aperture without focus.
std::map<int, GltfLens> checked_lenses(GltfLists& gltf);

}  // namespace patchlight
