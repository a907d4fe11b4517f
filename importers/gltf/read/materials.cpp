#include "importers/gltf/read/materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "importers/gltf/read/material_layers.h"
#include "importers/gltf/read/name_pattern.h"
#include "importers/gltf/read/scene_textures.h"
#include "importers/gltf/read/specular_glossiness.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr float kMaxReflectance = 0.99999f;
constexpr float kMaxEmission = 3e38f;
constexpr float kDefaultGrey = 0.8f;

Color color(const Vec3d& value) {
  return {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z)};
}

Vec3d vector(const std::vector<double>& values) {
  return {values.at(0), values.at(1), values.at(2)};
}

double emissive_strength(const tinygltf::Material& source) {
  const auto extension = source.extensions.find("KHR_materials_emissive_strength");
  if (extension == source.extensions.end() || !extension->second.Has("emissiveStrength")) return 1.0;
  return extension->second.Get("emissiveStrength").GetNumberAsDouble();
}

/// Reads the alpha mask. BLEND is a mask with a cutoff of 0: see Material::alpha_cutoff.
void read_mask(const tinygltf::Material& source, SceneTextures& textures, SurfaceMaterial& material) {
  if (source.alphaMode != "MASK" && source.alphaMode != "BLEND") return;
  constexpr float kLeastAlpha = 1.0f / 512;  // of a surface that is not absent
  const bool blend = source.alphaMode == "BLEND";
  const double alpha = source.pbrMetallicRoughness.baseColorFactor.at(3);
  if (!(alpha >= 0.0 && alpha <= 1.0))
    refuse_material(textures.model(), material.name, fmt::format("the alpha of its base colour factor is {}", alpha),
                    "in [0, 1]");
  if (!blend && !(source.alphaCutoff > 0.0)) return;
  const std::int32_t mask = textures.mask(source.pbrMetallicRoughness.baseColorTexture);
  const std::vector<std::int32_t>& texels = textures.mask_at(mask).texels;
  const auto [least, most] = std::minmax_element(texels.begin(), texels.end());
  material.alpha = static_cast<float>(alpha);
  material.alpha_cutoff = blend ? 0.0f : static_cast<float>(source.alphaCutoff);
  const float least_alpha = material.alpha * static_cast<float>(*least) / 255.0f;
  const float most_alpha = material.alpha * static_cast<float>(*most) / 255.0f;
  material.invisible = most_alpha < (blend ? kLeastAlpha : material.alpha_cutoff);
  material.masked_by_vertices_only = least_alpha >= (blend ? 1.0f : material.alpha_cutoff);
  material.has_uniform_mask = *least == *most;
  material.mask = mask;
}

SurfaceMaterial read_material(const tinygltf::Material& source, bool used, SceneTextures& textures) {
  const auto read = [&](const tinygltf::TextureInfo& info, TextureEncoding encoding) {
    return used ? textures.texture(info, encoding) : std::pair(Vec3d(1.0), std::int32_t{-1});
  };
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const bool unlit = source.extensions.contains("KHR_materials_unlit");  // then not metallic
  const double metallic_factor = unlit ? 0.0 : pbr.metallicFactor;

  SurfaceMaterial material;
  material.name = source.name.empty() ? "default" : source.name;
  // Roughness is in the green channel, metallic in the blue one.
  const auto [metallic_roughness, metallic_roughness_texture] =
      read(pbr.metallicRoughnessTexture, TextureEncoding::linear);
  const auto [base_mean, texture] = read(pbr.baseColorTexture, TextureEncoding::srgb);
  const auto [emissive_mean, emission_texture] = read(source.emissiveTexture, TextureEncoding::srgb);
  const Vec3d factor = vector(pbr.baseColorFactor), base = factor * base_mean;
  const Vec3d emissive = vector(source.emissiveFactor) * (kPi * emissive_strength(source));
  if (!(metallic_factor >= 0.0 && metallic_factor <= 1.0)) {
    refuse_material(textures.model(), material.name, fmt::format("its metallic factor is {}", metallic_factor),
                    "in [0, 1]");
  }
  if (!(pbr.roughnessFactor >= 0.0 && pbr.roughnessFactor <= 1.0)) {
    refuse_material(textures.model(), material.name, fmt::format("its roughness factor is {}", pbr.roughnessFactor),
                    "in [0, 1]");
  }
  const double metallic = metallic_factor * metallic_roughness.z;
  material.reflectance = color(base * (1.0 - metallic));
  material.texture = texture;
  if (used) read_mask(source, textures, material);
  if (texture >= 0) material.mapping = mapping_of(pbr.baseColorTexture);
  material.tint = color(factor * (1.0 - metallic_factor));
  material.transmission = read_transmission(source, textures, used, material.name);
  material.transmission.part *= static_cast<float>(1.0 - metallic);
  material.transmission.tint = color(factor);
  const DiffuseTransmission diffuse = read_diffuse_transmission(source, textures, used, material.name);
  material.translucence = diffuse.color * diffuse.part * static_cast<float>(1.0 - metallic);
  for (Color* const color : {&material.reflectance, &material.tint, &material.translucence})
    *color *= 1.0f - material.transmission.part;
  for (Color* const color : {&material.reflectance, &material.tint}) *color *= 1.0f - diffuse.part;
  material.metal = color(factor * metallic_factor);
  material.specular = color(base * metallic);
  material.roughness = static_cast<float>(pbr.roughnessFactor * metallic_roughness.y);
  const bool all_metal = metallic_factor == 1.0 && metallic_roughness_texture < 0;
  if (!unlit && !all_metal) material.coat = read_coat(source, textures, used, material.name);
  material.coat.metallic = static_cast<float>(metallic_factor);
  if (!unlit && !material.transmission.exists())
    material.clear_coat = read_clear_coat(source, textures, used, material.name);
  if (metallic_factor > 0.0 || material.coat.exists()) material.metallic_roughness_texture = metallic_roughness_texture;
  material.metallic_roughness_mapping = mapping_of(pbr.metallicRoughnessTexture);
  material.mean_metallic = static_cast<float>(metallic_roughness.z);
  material.roughness_factor = static_cast<float>(pbr.roughnessFactor);
  material.emission = color(emissive * emissive_mean);
  material.emission_tint = color(emissive);
  if (material.emits()) material.emission_texture = emission_texture;
  material.emission_mapping = mapping_of(source.emissiveTexture);
  if (!unlit) {
    tinygltf::TextureInfo info;
    info.index = source.normalTexture.index;
    info.texCoord = source.normalTexture.texCoord;
    info.extensions = source.normalTexture.extensions;
    material.normal_texture = read(info, TextureEncoding::linear).second;
    material.normal_mapping = mapping_of(info);
    material.normal_scale = static_cast<float>(source.normalTexture.scale);
  }
  material.double_sided = source.doubleSided;
  if (source.extras.Has("light_group") && source.extras.Get("light_group").IsString()) {
    material.light_group = source.extras.Get("light_group").Get<std::string>();
  }
  return material;
}

/// Of surfaces without a material.
SurfaceMaterial default_material() {
  SurfaceMaterial material;
  material.name = "default";
  material.reflectance = material.tint = Color(kDefaultGrey);
  return material;
}

/// `value`, limited to 1 - `other` per channel, so that both reflectances together do not exceed 1.
Color limited_by(const Color& value, const Color& other) {
  Color result = value;
  for (int i = 0; i < 3; ++i) result[i] = std::min(result[i], std::max(0.0f, 1.0f - other[i]));
  return result;
}

/// Replaces the metallic-roughness texture by its mean.
void average_metallic_roughness(SurfaceMaterial& material) {
  if (material.metallic_roughness_texture >= 0) material.coat.metallic *= material.mean_metallic;
  material.tint += material.metal * (1.0f - material.mean_metallic);
  material.metal = Color(0.0f);
  material.metallic_roughness_texture = -1;
}

/// `section` of the job: "materials" or "nodes".
void apply_override(const MaterialOverride& change, const char* section, SurfaceMaterial& material) {
  if (change.light_group) {
    material.light_group = *change.light_group;
    material.light_group_from_job = true;
  }
  if (change.patch_area) material.patch_area = *change.patch_area;
  if (change.emission) {
    material.emission = *change.emission;
    material.emission_texture = -1;
    material.emission_tint = Color(0.0f);
  }
  if (change.reflectance || change.mirror) average_metallic_roughness(material);
  if (change.reflectance) {
    material.reflectance = material.tint = *change.reflectance;
    material.texture = -1;
    if (material.mask < 0) material.mapping = {};
    material.reflectance_overridden = true;
    material.transmission = {};
    material.translucence = Color(0.0f);
  }
  if (change.mirror) {
    material.specular = *change.mirror;
    material.roughness = 0.0f;
    material.coat = {};
    material.clear_coat = {};
    material.transmission = {};
    material.translucence = Color(0.0f);
  }
  if (change.specular || change.ior) {
    Coat& coat = material.coat;
    const auto ior = static_cast<float>(change.ior.value_or(coat.ior > 0 ? coat.ior : 1.5f));
    const auto factor = static_cast<float>(change.specular.value_or(coat.exists() ? coat.grazing : 1.0f));
    coat.normal = Color(factor * (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1)));
    coat.grazing = factor;
    coat.ior = ior;
    if (change.ior) material.transmission.ior = ior;
  }
  if (change.roughness) {
    material.roughness = static_cast<float>(*change.roughness);
    average_metallic_roughness(material);
  }
  if (change.reflectance && change.mirror) {
    const Color sum = *change.reflectance + *change.mirror;
    if (std::max({sum.x, sum.y, sum.z}) > 1.000001f) {
      throw Error(ExitCode::bad_config, "reflectance and mirror together exceed 1",
                  fmt::format("{}.{}", section, change.pattern), "lower one of them");
    }
  } else if (change.reflectance) {
    material.specular = limited_by(material.specular, material.reflectance);
  } else if (change.mirror) {
    material.reflectance = limited_by(material.reflectance, material.specular);
  }
}

void apply_overrides(const Job& job, std::vector<SurfaceMaterial>& materials, Progress& progress) {
  for (const MaterialOverride& change : job.materials) {
    bool found = false;
    for (SurfaceMaterial& material : materials) {
      if (!matches(change.pattern, material.name)) continue;
      apply_override(change, "materials", material);
      found = true;
    }
    if (!found)
      progress.warning(fmt::format("materials.{} in the job matches no material of the scene", change.pattern));
  }
}

void check_values(const GltfModel& model, SurfaceMaterial& material, Progress& progress) {
  bool lowered = false;
  for (int i = 0; i < 3; ++i) {
    float& reflectance = material.reflectance[i];
    const float specular = material.specular[i];
    const float emission = material.emission[i];
    if (!(reflectance >= 0.0f && reflectance <= 1.0f)) {
      refuse_material(model, material.name, fmt::format("its reflectance is {}", reflectance), "in [0, 1]");
    }
    if (!(specular >= 0.0f && specular <= 1.0f)) {
      refuse_material(model, material.name, fmt::format("its specular reflectance is {}", specular), "in [0, 1]");
    }
    const float brightest = material.emission_texture < 0 ? emission : material.emission_tint[i];
    if (!(emission >= 0.0f && brightest >= 0.0f && brightest <= kMaxEmission)) {
      refuse_material(model, material.name, fmt::format("its emission is {} W/m2", brightest),
                      "finite and not negative");
    }
    if (!(material.tint[i] >= 0.0f && material.tint[i] <= 1.0f)) {
      refuse_material(model, material.name,
                      fmt::format("its base colour factor, times 1 - metallic, is {}", material.tint[i]), "in [0, 1]");
    }
    if (!(material.metal[i] >= 0.0f && material.metal[i] <= 1.0f)) {
      refuse_material(model, material.name,
                      fmt::format("its base colour factor, times metallic, is {}", material.metal[i]), "in [0, 1]");
    }
    lowered = lowered || reflectance > kMaxReflectance;
    reflectance = std::min(reflectance, kMaxReflectance);
  }
  if (lowered) {
    progress.warning(
        fmt::format("reflectance of material '{}' is lowered to {}: with more, light would never be absorbed",
                    material.name, kMaxReflectance));
  }
}

}  // namespace

std::vector<SurfaceMaterial> read_materials(GltfModel& model, const std::vector<char>& used, const Job& job,
                                            std::vector<Texture>& textures, std::vector<Texture>& masks,
                                            Progress& progress) {
  std::vector<SurfaceMaterial> materials;
  SceneTextures reader(model, progress, textures, masks);
  convert_specular_glossiness(model, used, reader);
  for (std::size_t i = 0; i < model.gltf.materials.size(); ++i) {
    materials.push_back(read_material(model.gltf.materials[i], used[i], reader));
  }
  if (used.back()) materials.push_back(default_material());
  apply_overrides(job, materials, progress);
  if (!job.import.dielectric_coat)
    for (SurfaceMaterial& material : materials) {
      material.coat = {};
      material.clear_coat = {};
    }
  for (SurfaceMaterial& material : materials) check_values(model, material, progress);
  return materials;
}

std::optional<SurfaceMaterial> node_material(const GltfModel& model, const Job& job, const std::string& node,
                                             const SurfaceMaterial& material, Progress& progress) {
  std::optional<SurfaceMaterial> result;
  for (const MaterialOverride& change : job.nodes) {
    if (!matches(change.pattern, node)) continue;
    if (!result) result = material;
    apply_override(change, "nodes", *result);
  }
  if (result) check_values(model, *result, progress);
  return result;
}

}  // namespace patchlight
