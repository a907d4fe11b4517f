#include "importers/gltf/read/material_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr double kMaxIor = 100;
constexpr double kDefaultIor = 1.5;
constexpr double kLeastPassed = 1e-6;  // of an attenuation colour, so that absorption is finite

tinygltf::Value extension(const tinygltf::Material& source, const char* key) {
  const auto found = source.extensions.find(key);
  return found == source.extensions.end() ? tinygltf::Value() : found->second;
}

double number(const tinygltf::Value& in, const char* key, double absent) {
  return in.Has(key) ? in.Get(key).GetNumberAsDouble() : absent;
}

/// Mean of a texture of an extension; ones without it.
Vec3d texture_mean(const tinygltf::Value& in, const char* key, TextureEncoding encoding, SceneTextures& textures) {
  if (!in.Has(key)) return Vec3d(1.0);
  tinygltf::TextureInfo info;
  info.index = in.Get(key).Get("index").GetNumberAsInt();
  return textures.mean(info, encoding);
}

}  // namespace

void refuse_material(const GltfModel& model, const std::string& material, const std::string& what,
                     const std::string& range) {
  throw Error(ExitCode::bad_data, what, fmt::format("{}, material '{}'", model.file.name, material),
              fmt::format("it must be {}; correct the material or override it in the job's `materials`", range));
}

Coat read_coat(const tinygltf::Material& source, SceneTextures& textures, bool used, const std::string& name) {
  const GltfModel& model = textures.model();
  const tinygltf::Value specular = extension(source, "KHR_materials_specular");
  const double ior = number(extension(source, "KHR_materials_ior"), "ior", 1.5);
  double factor = number(specular, "specularFactor", 1.0);
  if (!(factor >= 0 && factor <= 1))
    refuse_material(model, name, fmt::format("its specular factor is {}", factor), "in [0, 1]");
  if (ior != 0 && !(ior >= 1 && ior <= kMaxIor))
    refuse_material(model, name, fmt::format("its index of refraction is {}", ior),
                    fmt::format("0 or in [1, {}]", kMaxIor));
  // An index of 0 stands for a reflectance of 1 (compatibility with specular-glossiness).
  const double least = ior == 0 ? 1.0 : (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1));
  Color tint(1.0f);
  if (specular.Has("specularColorFactor"))
    for (int k = 0; k < 3; ++k)
      tint[k] = static_cast<float>(specular.Get("specularColorFactor").Get(k).GetNumberAsDouble());
  for (int k = 0; k < 3; ++k)
    if (!(tint[k] >= 0))
      refuse_material(model, name, fmt::format("its specular colour is {}", tint[k]), "not negative");
  if (used) {
    factor *= texture_mean(specular, "specularTexture", TextureEncoding::alpha, textures).x;
    tint *= Color(texture_mean(specular, "specularColorTexture", TextureEncoding::srgb, textures));
  }
  Coat coat;
  for (int k = 0; k < 3; ++k)
    coat.normal[k] = static_cast<float>(std::min(least * static_cast<double>(tint[k]), 1.0) * factor);
  coat.grazing = static_cast<float>(factor);
  coat.ior = ior >= 1 && tint == Color(1.0f) ? static_cast<float>(ior) : 0.0f;
  return coat;
}

ClearCoat read_clear_coat(const tinygltf::Material& source, SceneTextures& textures, bool used,
                          const std::string& name) {
  const tinygltf::Value coat = extension(source, "KHR_materials_clearcoat");
  double part = number(coat, "clearcoatFactor", 0.0), roughness = number(coat, "clearcoatRoughnessFactor", 0.0);
  if (!(part >= 0 && part <= 1))
    refuse_material(textures.model(), name, fmt::format("its clear coat factor is {}", part), "in [0, 1]");
  if (!(roughness >= 0 && roughness <= 1))
    refuse_material(textures.model(), name, fmt::format("its clear coat roughness is {}", roughness), "in [0, 1]");
  if (part > 0 && used) {
    part *= texture_mean(coat, "clearcoatTexture", TextureEncoding::linear, textures).x;
    roughness *= texture_mean(coat, "clearcoatRoughnessTexture", TextureEncoding::linear, textures).y;
  }
  return {static_cast<float>(part), static_cast<float>(roughness)};
}

Transmission read_transmission(const tinygltf::Material& source, SceneTextures& textures, bool used,
                               const std::string& name) {
  Transmission result;
  const tinygltf::Value glass = extension(source, "KHR_materials_transmission");
  double part = number(glass, "transmissionFactor", 0.0);
  if (!(part >= 0 && part <= 1))
    refuse_material(textures.model(), name, fmt::format("its transmission factor is {}", part), "in [0, 1]");
  if (part > 0 && used) part *= texture_mean(glass, "transmissionTexture", TextureEncoding::linear, textures).x;
  if (!(part > 0)) return result;
  result.part = static_cast<float>(part);
  const double ior = number(extension(source, "KHR_materials_ior"), "ior", kDefaultIor);
  result.ior = static_cast<float>(ior >= 1 ? ior : kDefaultIor);
  const tinygltf::Value volume = extension(source, "KHR_materials_volume");
  result.solid = number(volume, "thicknessFactor", 0.0) > 0;
  const double distance = number(volume, "attenuationDistance", 0.0);
  if (!result.solid || !(distance > 0) || !volume.Has("attenuationColor")) return result;
  for (int k = 0; k < 3; ++k) {
    const double passed = volume.Get("attenuationColor").Get(k).GetNumberAsDouble();
    if (!(passed >= 0 && passed <= 1))
      refuse_material(textures.model(), name, fmt::format("its attenuation colour is {}", passed), "in [0, 1]");
    result.absorption[k] = static_cast<float>(-std::log(std::max(passed, kLeastPassed)) / distance);
  }
  return result;
}

DiffuseTransmission read_diffuse_transmission(const tinygltf::Material& source, SceneTextures& textures, bool used,
                                              const std::string& name) {
  DiffuseTransmission result;
  const tinygltf::Value passing = extension(source, "KHR_materials_diffuse_transmission");
  double part = number(passing, "diffuseTransmissionFactor", 0.0);
  if (!(part >= 0 && part <= 1))
    refuse_material(textures.model(), name, fmt::format("its diffuse transmission factor is {}", part), "in [0, 1]");
  Vec3d color(1.0);
  for (int k = 0; k < 3 && passing.Has("diffuseTransmissionColorFactor"); ++k) {
    color[k] = passing.Get("diffuseTransmissionColorFactor").Get(k).GetNumberAsDouble();
    if (!(color[k] >= 0 && color[k] <= 1))
      refuse_material(textures.model(), name, fmt::format("its diffuse transmission colour is {}", color[k]),
                      "in [0, 1]");
  }
  if (part > 0 && used) {
    part *= texture_mean(passing, "diffuseTransmissionTexture", TextureEncoding::alpha, textures).x;
    color *= texture_mean(passing, "diffuseTransmissionColorTexture", TextureEncoding::srgb, textures);
  }
  result.part = static_cast<float>(part);
  result.color = Color(color);
  return result;
}

}  // namespace patchlight
