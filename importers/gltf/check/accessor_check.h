#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <vector>

#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Check that bufferViews lie within their buffers, and accessors within their bufferViews.
/// Throw: Error (bad_data) naming the element.
void check_buffer_views(const GltfLists& gltf, const std::vector<GltfData>& buffers);
void check_accessors(const GltfLists& gltf);

/// Bytes of a component; 0 for a number that is no glTF componentType.
std::int64_t component_size(std::int64_t component_type);

}  // namespace patchlight
