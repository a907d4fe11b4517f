#include "importers/gltf/check/material_extensions.h"

#include <fmt/format.h>

#include "importers/gltf/check/texture_check.h"

namespace patchlight {

const std::vector<MaterialExtension>& material_extensions() {
  static const std::vector<MaterialExtension> extensions{
      {"KHR_materials_emissive_strength", {"emissiveStrength"}},
      {"KHR_materials_ior", {"ior"}},
      {"KHR_materials_specular",
       {"specularFactor"},
       {"specularColorFactor"},
       {"specularTexture", "specularColorTexture"}},
      {"KHR_materials_clearcoat",
       {"clearcoatFactor", "clearcoatRoughnessFactor"},
       {},
       {"clearcoatTexture", "clearcoatRoughnessTexture"}},
      {"KHR_materials_transmission", {"transmissionFactor"}, {}, {"transmissionTexture"}},
      {"KHR_materials_diffuse_transmission",
       {"diffuseTransmissionFactor"},
       {"diffuseTransmissionColorFactor"},
       {"diffuseTransmissionTexture", "diffuseTransmissionColorTexture"}},
      {"KHR_materials_volume", {"thicknessFactor", "attenuationDistance"}, {"attenuationColor"}}};
  return extensions;
}

void check_material_extensions(GltfLists& gltf, const Json& extensions, const GltfPlace& place) {
  for (const MaterialExtension& extension : material_extensions()) {
    const Json* values = find_object(extensions, extension.name, place);
    if (!values) continue;
    for (const char* key : extension.numbers) check_number(*values, key, place);
    for (const char* key : extension.colors) check_numbers(*values, key, 3, place);
    for (const char* key : extension.textures) {
      check_texture_info(gltf, *values, key, place);
      if (values->contains(key))
        gltf.ignored.insert(fmt::format("textures of {} are replaced by their means", extension.name));
    }
  }
}

Json reduced_material_extensions(const Json& extensions) {
  Json result = Json::object();
  for (const MaterialExtension& extension : material_extensions()) {
    const Json* values = find_member(extensions, extension.name);
    if (!values) continue;
    Json& reduced = result[extension.name] = Json::object();
    for (const auto* keys : {&extension.numbers, &extension.colors})
      for (const char* key : *keys)
        if (const Json* value = find_member(*values, key)) reduced[key] = *value;
    for (const char* key : extension.textures)
      if (const Json* info = find_member(*values, key)) reduced[key] = {{"index", info->at("index")}};
  }
  return result;
}

}  // namespace patchlight
