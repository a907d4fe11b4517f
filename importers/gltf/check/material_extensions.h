#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <string_view>
#include <vector>

#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// What is read of an extension of materials.
struct MaterialExtension {
  const char* name;
  std::vector<const char*> numbers{}, colors{};
  std::vector<const char*> textures{};  ///< Their means count.
};

/// The extensions that add numbers, colours and textures to a material.
const std::vector<MaterialExtension>& material_extensions();

/// Checks those of a material. Throws: Error (bad_data) naming the material.
void check_material_extensions(GltfLists& gltf, const Json& extensions, const GltfPlace& place);

/// What the importer reads of those of a checked material.
Json reduced_material_extensions(const Json& extensions);

}  // namespace patchlight
