#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Whether bytes begin as those of a WebP image do.
bool is_webp(std::span<const unsigned char> bytes);

/// What the chunks of a WebP image say.
struct WebpHeader {
  std::int64_t width = 0, height = 0;  ///< 0: damaged.
  bool has_alpha = false;
  bool is_animated = false;
};

/// Expects the bytes of a WebP image, damaged or not.
WebpHeader webp_header(std::span<const unsigned char> bytes);

/// The image with its colours alone. OpenImageIO multiplies those of an image with alpha by it, which cannot be undone
/// where alpha is 0.
std::vector<unsigned char> webp_without_alpha(std::span<const unsigned char> bytes);

}  // namespace patchlight
