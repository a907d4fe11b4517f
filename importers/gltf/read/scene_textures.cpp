#include "importers/gltf/read/scene_textures.h"

#include <fmt/format.h>

#include "importers/gltf/check/texture_check.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

Texture::Wrap wrap_of(int gltf) {
  if (gltf == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
  return gltf == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Texture::Wrap::mirror : Texture::Wrap::repeat;
}

Texture opaque_mask() {
  Texture mask;
  mask.width = mask.height = 1;
  mask.texels = {255};
  return mask;
}

}  // namespace

SceneTextures::SceneTextures(GltfModel& model, Progress& progress, std::vector<Texture>& textures,
                             std::vector<Texture>& masks)
    : model_(model), progress_(progress), textures_(textures), masks_(masks) {}

std::pair<Vec3d, std::int32_t> SceneTextures::texture(const tinygltf::TextureInfo& info, TextureEncoding encoding) {
  const std::pair<Vec3d, std::int32_t> none(Vec3d(1.0), -1);
  if (info.index < 0) return none;
  const tinygltf::Texture& source = model_.gltf.textures[info.index];
  const int image = image_of(info.index);
  if (image < 0) {
    progress_.warning(
        fmt::format("textures[{}] has no PNG, JPEG or WebP image: only the material's factor is used", info.index));
    return none;
  }
  const auto [entry, is_new] =
      read_textures_.emplace(std::pair(info.index, encoding), std::pair(Vec3d(1.0), std::int32_t(textures_.size())));
  if (is_new) entry->second.first = read(image, encoding, &textures_.emplace_back(without_texels(source)));
  return entry->second;
}

Vec3d SceneTextures::mean(const tinygltf::TextureInfo& info, TextureEncoding encoding) {
  const int image = info.index < 0 ? -1 : image_of(info.index);
  return image < 0 ? Vec3d(1.0) : read(image, encoding, nullptr);
}

std::int32_t SceneTextures::mask(const tinygltf::TextureInfo& info) {
  const int image = info.index < 0 ? -1 : image_of(info.index);
  const bool none = image < 0;
  const auto [entry, is_new] = read_masks_.emplace(none ? -1 : info.index, std::int32_t(masks_.size()));
  if (!is_new) return entry->second;
  if (none) {
    masks_.push_back(opaque_mask());
    return entry->second;
  }
  const tinygltf::Texture& source = model_.gltf.textures[info.index];
  Texture texture = without_texels(source);
  read(image, TextureEncoding::alpha, &texture);
  masks_.push_back(texture.texels.empty() ? opaque_mask() : std::move(texture));
  return entry->second;
}

/// -1: none.
int SceneTextures::image_of(int texture) const {
  const tinygltf::Texture& source = model_.gltf.textures[texture];
  if (source.source < 0 && source.extensions.contains(kBasisu)) {
    throw Error(ExitCode::bad_data,
                fmt::format("the texture's only image is compressed by {}, which is not supported", kBasisu),
                fmt::format("{}, textures[{}]", model_.file.name, texture),
                "convert the scene's textures to PNG: `gltf-transform ktxdecompress SCENE.glb CONVERTED.glb`");
  }
  return source.source;
}

Texture SceneTextures::without_texels(const tinygltf::Texture& source) const {
  Texture texture;
  if (source.sampler < 0) return texture;
  const tinygltf::Sampler& sampler = model_.gltf.samplers[source.sampler];
  texture.wrap = {wrap_of(sampler.wrapS), wrap_of(sampler.wrapT)};
  texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  return texture;
}

Vec3d SceneTextures::read(int image, TextureEncoding encoding, Texture* texture) {
  std::shared_ptr<const Bytes> owner;
  const std::string place = fmt::format("{}, {}", model_.file.name, model_.checked.images[image].name);
  return read_texture(image_bytes(model_, image, owner), encoding, place, texels_left_, texture);
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

}  // namespace patchlight
