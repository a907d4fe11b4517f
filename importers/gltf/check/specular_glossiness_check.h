#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

/// The extension of a material, which takes precedence over its metallic-roughness; null if it has none or is unlit.
const Json* find_specular_glossiness(const Json& material, const GltfPlace& place);

/// Checks the extension of a material, if it has it. Throws: Error (bad_data) naming the material.
void check_specular_glossiness(GltfLists& gltf, const Json& material, const GltfPlace& place);

/// The metallic-roughness of a dielectric with the diffuse part and the glossiness of a checked extension.
Json dielectric_of(const Json& extension);

}  // namespace patchlight
