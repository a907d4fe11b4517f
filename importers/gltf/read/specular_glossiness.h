#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "importers/gltf/read/scene_textures.h"

namespace patchlight {

/// Gives the materials of KHR_materials_pbrSpecularGlossiness that are in use (`used`, by material) the
/// metallic-roughness nearest to them. Expects that of a dielectric with the same diffuse part, as check_gltf leaves
/// it. A material whose specular reflectance is at most 0.08 stays a dielectric. Textures count by their means; the
/// diffuse texture of a metal is left out, unless its alpha is needed. Throws: Error as SceneTextures::mean does.
/// Source: Khronos' conversion in glTF's extension KHR_materials_pbrSpecularGlossiness.
void convert_specular_glossiness(GltfModel& model, const std::vector<char>& used, SceneTextures& textures);

}  // namespace patchlight
