#include "importers/gltf/textures/texture_reader.h"

#include "pipeline/system/on_demand.h"

namespace patchlight {

Vec3d read_texture(std::span<const unsigned char> bytes, TextureEncoding encoding, const std::string& place,
                   std::int64_t& texels_left, Texture* kept) {
  static auto* const decode = on_demand<decltype(decode_texture)>("patchlight-textures", "decode_texture");
  Vec3d mean;
  decode(bytes, encoding, place, texels_left, kept, mean);
  return mean;
}

}  // namespace patchlight
