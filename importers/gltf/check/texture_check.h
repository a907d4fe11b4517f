#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

constexpr const char* kWebp = "EXT_texture_webp";
constexpr const char* kBasisu = "KHR_texture_basisu";

/// Check textures with their samplers, and a textureInfo if `owner` has it. Throw: Error (bad_data) naming the element.
void check_textures(const GltfLists& gltf);
void check_texture_info(const GltfLists& gltf, const Json& owner, const char* key, const GltfPlace& place);

/// Index of the image to read of a checked texture: its WebP image, or else its plain one; -1 without either.
int texture_image(const Json& texture);

}  // namespace patchlight
