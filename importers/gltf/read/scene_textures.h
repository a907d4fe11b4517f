#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "importers/gltf/textures/texture_reader.h"
#include "importers/mesh/surface.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Reads the textures and alpha masks of a scene, each once.
class SceneTextures {
 public:
  /// Appends what it reads to `textures` and `masks`.
  SceneTextures(GltfModel& model, Progress& progress, std::vector<Texture>& textures, std::vector<Texture>& masks);

  /// Mean value of a texture, and its index in `textures`. Without an image: ones and -1.
  /// Throws: Error as read_texture and image_bytes do; (bad_data) if its only image is of KHR_texture_basisu.
  std::pair<Vec3d, std::int32_t> texture(const tinygltf::TextureInfo& info, TextureEncoding encoding);

  /// Mean value of a texture that the scene does not keep; ones without an image. Throws: Error as texture() does.
  Vec3d mean(const tinygltf::TextureInfo& info, TextureEncoding encoding);

  /// Index in `masks` of a base colour texture's alpha; of a single opaque texel without a texture or without alpha.
  /// Throws: Error as read_texture and image_bytes do.
  std::int32_t mask(const tinygltf::TextureInfo& info);

  const GltfModel& model() const { return model_; }
  const Texture& mask_at(std::int32_t index) const { return masks_[static_cast<std::size_t>(index)]; }

 private:
  int image_of(int texture) const;
  Texture without_texels(const tinygltf::Texture& source) const;
  Vec3d read(int image, TextureEncoding encoding, Texture* texture);

  GltfModel& model_;
  Progress& progress_;
  std::vector<Texture>& textures_;
  std::vector<Texture>& masks_;
  std::int64_t texels_left_ = kMaxSceneTexels;
  std::map<std::pair<int, TextureEncoding>, std::pair<Vec3d, std::int32_t>> read_textures_;  ///< Results of texture().
  std::map<int, std::int32_t> read_masks_;  ///< By glTF texture; -1: the opaque mask.
};

/// The texture coordinate set and KHR_texture_transform of a checked textureInfo.
TextureMapping mapping_of(const tinygltf::TextureInfo& info);

}  // namespace patchlight
