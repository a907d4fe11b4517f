#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "pipeline/model/math.h"
#include "pipeline/model/texture.h"

namespace patchlight {

/// How an image's values are meant; `alpha`: of its fourth channel alone, or the second of two.
enum class TextureEncoding { srgb, linear, alpha };

/// Texels that one scene may decode; a small file can hold an enormous image.
constexpr std::int64_t kMostTexels = std::int64_t{1} << 30;

/// Mean linear colour of a PNG or JPEG image, each channel in [0,1]; sRGB is linearised texel by texel. Size and texels
/// go into `kept`, if there is one: of alpha values in [0,255], and none for an image without alpha, whose mean is 1.
/// Takes the image's size off `texels_left`. `place` names the image for errors.
/// Throws: Error (bad_data) for another format or a damaged image; (over_limit) for more than 8192 x 8192 texels or
/// more than are left.
Vec3d read_texture(std::span<const unsigned char> bytes, TextureEncoding encoding, const std::string& place,
                   std::int64_t& texels_left, Texture* kept);

/// What read_texture loads when it is first called.
extern "C" void decode_texture(std::span<const unsigned char> bytes, TextureEncoding encoding, const std::string& place,
                               std::int64_t& texels_left, Texture* kept, Vec3d& mean);

}  // namespace patchlight
