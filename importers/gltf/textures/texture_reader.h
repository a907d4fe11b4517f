#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "pipeline/model/math.h"
#include "pipeline/model/texture.h"

namespace patchlight {

/// How to interpret an image's values. `alpha`: only the alpha channel, which is the last of two or four.
enum class TextureEncoding { srgb, linear, alpha };

/// Maximum number of texels of one scene; a small file can contain an enormous image.
constexpr std::int64_t kMaxSceneTexels = std::int64_t{1} << 30;

/// Mean linear colour of a PNG, JPEG or WebP image, each channel in [0,1]; sRGB is linearised before averaging. Stores
/// size and texels in `kept` unless it is null; with TextureEncoding::alpha, values in [0,255], and nothing for an
/// image without alpha, whose mean is 1. Subtracts the image's texels from `texels_left`. `place` names the image in
/// errors. Throws: Error (bad_data) for another format, an animation or a damaged image; (over_limit) for more than
/// 8192 x 8192 texels or more than are left.
Vec3d read_texture(std::span<const unsigned char> bytes, TextureEncoding encoding, const std::string& place,
                   std::int64_t& texels_left, Texture* kept);

/// The implementation in the plugin, which read_texture loads at its first call.
extern "C" void decode_texture(std::span<const unsigned char> bytes, TextureEncoding encoding, const std::string& place,
                               std::int64_t& texels_left, Texture* kept, Vec3d& mean);

}  // namespace patchlight
