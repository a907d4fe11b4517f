#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include <vector>

#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks that bufferViews lie within their buffers and accessors, sparse ones too, within bufferViews.
/// Throws: Error (bad_data) naming the place.
void check_buffer_views(const GltfLists& gltf, const std::vector<GltfData>& buffers);
void check_accessors(const GltfLists& gltf);

/// Bytes of a component of an accessor's type; 0 for what is none of glTF's.
std::int64_t component_size(std::int64_t component_type);

}  // namespace patchlight
