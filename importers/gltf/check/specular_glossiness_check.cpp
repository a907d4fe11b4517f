#include "importers/gltf/check/specular_glossiness_check.h"

#include "importers/gltf/check/texture_check.h"

namespace patchlight {
namespace {

void check_fraction(const Json& value, const char* key, const GltfPlace& place) {
  if (!(value.get<double>() >= 0.0 && value.get<double>() <= 1.0)) refuse_gltf("must be in [0, 1]", place, key);
}

}  // namespace

const Json* find_specular_glossiness(const Json& material, const GltfPlace& place) {
  return find_extension(material, "KHR_materials_unlit", place) ? nullptr
                                                                : find_extension(material, kSpecularGlossiness, place);
}

void check_specular_glossiness(GltfLists& gltf, const Json& material, const GltfPlace& place) {
  const Json* extension = find_specular_glossiness(material, place);
  if (!extension) return;
  check_numbers(*extension, "diffuseFactor", 4, place);
  check_numbers(*extension, "specularFactor", 3, place);
  check_number(*extension, "glossinessFactor", place);
  for (const char* key : {"diffuseFactor", "specularFactor"})
    for (const Json& value : extension->value(key, Json::array())) check_fraction(value, key, place);
  if (const Json* glossiness = find_member(*extension, "glossinessFactor"))
    check_fraction(*glossiness, "glossinessFactor", place);
  check_texture_info(gltf, *extension, "diffuseTexture", place);
  check_texture_info(gltf, *extension, "specularGlossinessTexture", place);
  gltf.ignored.insert("materials of KHR_materials_pbrSpecularGlossiness are converted to metallic-roughness");
  if (extension->contains("specularGlossinessTexture"))
    gltf.ignored.insert("specular-glossiness textures are replaced by their means");
}

Json dielectric_of(const Json& extension) {
  Json result{{"metallicFactor", 0.0}, {"roughnessFactor", 1.0 - extension.value("glossinessFactor", 1.0)}};
  if (const Json* factor = find_member(extension, "diffuseFactor")) result["baseColorFactor"] = *factor;
  if (const Json* texture = find_member(extension, "diffuseTexture")) result["baseColorTexture"] = *texture;
  return result;
}

}  // namespace patchlight
