#include "importers/gltf_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "importers/name_pattern.h"
#include "importers/texture_reader.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr float kHighestReflectance = 0.99999f;
constexpr float kStrongestEmission = 3e38f;
constexpr float kDefaultGrey = 0.8f;

Texture::Wrap wrap_of(int gltf) {
  if (gltf == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
  return gltf == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Texture::Wrap::mirror : Texture::Wrap::repeat;
}

/// The textures that were looked up: mean colours, and base colours whole.
struct TextureReader {
  GltfModel& model;
  Progress& progress;
  std::vector<Texture>& textures;
  std::int64_t texels_left = kMostTexels;
  std::map<std::pair<int, TextureEncoding>, Vec3d> known{};
  std::map<int, std::pair<Vec3d, std::int32_t>> whole{};
  bool averaged = false;

  /// The mean of a base colour, and the number of its texture.
  std::pair<Vec3d, std::int32_t> base_color(const tinygltf::TextureInfo& info) {
    if (info.index < 0 || model.gltf.textures[info.index].source < 0)
      return {of(info.index, TextureEncoding::srgb), -1};
    const auto [entry, is_new] = whole.emplace(info.index, std::pair(Vec3d(1.0), std::int32_t(textures.size())));
    if (!is_new) return entry->second;
    const tinygltf::Texture& source = model.gltf.textures[info.index];
    Texture& texture = textures.emplace_back();
    if (source.sampler >= 0) {
      const tinygltf::Sampler& sampler = model.gltf.samplers[source.sampler];
      texture.wrap = {wrap_of(sampler.wrapS), wrap_of(sampler.wrapT)};
      texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    entry->second.first = read(source.source, TextureEncoding::srgb, &texture);
    return entry->second;
  }

  Vec3d of(int texture, TextureEncoding encoding) {
    if (texture < 0) return Vec3d(1.0);
    const int image = model.gltf.textures[texture].source;
    if (image < 0) {
      progress.warning(
          fmt::format("textures[{}] has no PNG or JPEG image: only the material's factor counts", texture));
      return Vec3d(1.0);
    }
    const auto [entry, is_new] = known.emplace(std::pair(image, encoding), Vec3d(1.0));
    if (is_new) entry->second = read(image, encoding, nullptr);
    averaged = true;
    return entry->second;
  }

  Vec3d read(int image, TextureEncoding encoding, Texture* kept) {
    std::shared_ptr<const Bytes> owner;
    const std::string place = fmt::format("{}, {}", model.file.name, model.checked.images[image].name);
    return read_texture(image_bytes(model, image, owner), encoding, place, texels_left, kept);
  }
};

[[noreturn]] void refuse(const GltfModel& model, const std::string& material, const std::string& what,
                         const std::string& range) {
  throw Error(ExitCode::bad_data, what, fmt::format("{}, material '{}'", model.file.name, material),
              fmt::format("it must be {}; mend the material or override it in the job's `materials`", range));
}

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

TextureMapping mapping_of(const tinygltf::TextureInfo& info) {
  TextureMapping mapping;
  mapping.set = info.texCoord;
  const auto extension = info.extensions.find("KHR_texture_transform");
  if (extension == info.extensions.end()) return mapping;
  const tinygltf::Value& transform = extension->second;
  const auto pair = [&](const char* key, Vec2f& result) {
    if (!transform.Has(key)) return;
    for (int i = 0; i < 2; ++i) result[i] = static_cast<float>(transform.Get(key).Get(i).GetNumberAsDouble());
  };
  pair("offset", mapping.offset);
  pair("scale", mapping.scale);
  if (transform.Has("rotation")) mapping.rotation = static_cast<float>(transform.Get("rotation").GetNumberAsDouble());
  if (transform.Has("texCoord")) mapping.set = transform.Get("texCoord").GetNumberAsInt();
  return mapping;
}

SurfaceMaterial read_material(const tinygltf::Material& source, bool used, TextureReader& textures) {
  const auto mean = [&](int texture, TextureEncoding encoding) {
    return used ? textures.of(texture, encoding) : Vec3d(1.0);
  };
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  // G is roughness, B metallic.
  const Vec3d finish = mean(pbr.metallicRoughnessTexture.index, TextureEncoding::linear);
  const double metallic = pbr.metallicFactor * finish.z;
  const auto [base_mean, texture] =
      used ? textures.base_color(pbr.baseColorTexture) : std::pair(Vec3d(1.0), std::int32_t{-1});
  const Vec3d factor = vector(pbr.baseColorFactor), base = factor * base_mean;
  const Vec3d emissive = vector(source.emissiveFactor) * mean(source.emissiveTexture.index, TextureEncoding::srgb);

  SurfaceMaterial material;
  material.name = source.name.empty() ? "default" : source.name;
  if (!(metallic >= 0.0 && metallic <= 1.0)) {
    refuse(textures.model, material.name, fmt::format("metallic is {}", metallic), "in [0, 1]");
  }
  if (!(pbr.roughnessFactor >= 0.0 && pbr.roughnessFactor <= 1.0)) {
    refuse(textures.model, material.name, fmt::format("roughness is {}", pbr.roughnessFactor), "in [0, 1]");
  }
  material.reflectance = color(base * (1.0 - metallic));
  material.texture = texture;
  if (texture >= 0) material.mapping = mapping_of(pbr.baseColorTexture);
  material.tint = color(factor * (1.0 - metallic));
  material.specular = color(base * metallic);
  material.roughness = static_cast<float>(pbr.roughnessFactor * finish.y);
  material.emission = color(emissive * (kPi * emissive_strength(source)));
  material.double_sided = source.doubleSided;
  if (source.extras.Has("light_group") && source.extras.Get("light_group").IsString()) {
    material.light_group = source.extras.Get("light_group").Get<std::string>();
  }
  return material;
}

SurfaceMaterial default_material() {
  SurfaceMaterial material;
  material.name = "default";
  material.reflectance = Color(kDefaultGrey);
  return material;
}

/// What is left for one kind of reflection beside the other.
Color at_most_rest(const Color& value, const Color& other) {
  Color result = value;
  for (int i = 0; i < 3; ++i) result[i] = std::min(result[i], std::max(0.0f, 1.0f - other[i]));
  return result;
}

/// `section` of the job is materials or nodes.
void apply_override(const MaterialOverride& change, const char* section, SurfaceMaterial& material) {
  if (change.light_group) {
    material.light_group = *change.light_group;
    material.group_from_job = true;
  }
  if (change.patch_area) material.patch_area = *change.patch_area;
  if (change.emission) material.emission = *change.emission;
  if (change.reflectance) {
    material.reflectance = *change.reflectance;
    material.texture = -1;
    material.mapping = {};
    material.overridden = true;
  }
  if (change.mirror) {
    material.specular = *change.mirror;
    material.roughness = 0.0f;
  }
  if (change.reflectance && change.mirror) {
    const Color sum = *change.reflectance + *change.mirror;
    if (std::max({sum.x, sum.y, sum.z}) > 1.000001f) {
      throw Error(ExitCode::bad_config, "reflectance and mirror together exceed 1",
                  fmt::format("{}.{}", section, change.pattern), "lower one of them");
    }
  } else if (change.reflectance) {
    material.specular = at_most_rest(material.specular, material.reflectance);
  } else if (change.mirror) {
    material.reflectance = at_most_rest(material.reflectance, material.specular);
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
      refuse(model, material.name, fmt::format("reflectance is {}", reflectance), "in [0, 1]");
    }
    if (!(specular >= 0.0f && specular <= 1.0f)) {
      refuse(model, material.name, fmt::format("mirror reflectance is {}", specular), "in [0, 1]");
    }
    if (!(emission >= 0.0f && emission <= kStrongestEmission)) {
      refuse(model, material.name, fmt::format("emission is {} W/m2", emission), "finite and not negative");
    }
    if (material.texture >= 0 && !(material.tint[i] >= 0.0f && material.tint[i] <= 1.0f)) {
      refuse(model, material.name, fmt::format("the factor of its texture is {}", material.tint[i]), "in [0, 1]");
    }
    lowered = lowered || reflectance > kHighestReflectance;
    reflectance = std::min(reflectance, kHighestReflectance);
  }
  if (lowered) {
    progress.warning(fmt::format("reflectance of material '{}' lowered to {}: more would keep light forever",
                                 material.name, kHighestReflectance));
  }
}

}  // namespace

std::vector<SurfaceMaterial> read_materials(GltfModel& model, const std::vector<char>& used, const Job& job,
                                            std::vector<Texture>& textures, Progress& progress) {
  std::vector<SurfaceMaterial> materials;
  TextureReader reader{model, progress, textures};
  for (std::size_t i = 0; i < model.gltf.materials.size(); ++i) {
    materials.push_back(read_material(model.gltf.materials[i], used[i], reader));
  }
  if (reader.averaged) progress.warning("textures of finish and emission count by their mean colours");
  if (used.back()) {
    materials.push_back(default_material());
    progress.warning(fmt::format("what has no material is diffuse grey, {}", kDefaultGrey));
  }
  apply_overrides(job, materials, progress);
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
