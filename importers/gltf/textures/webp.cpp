// The container of WebP: https://developers.google.com/speed/webp/docs/riff_container, and RFC 9649.
#include "importers/gltf/textures/webp.h"

#include <algorithm>
#include <string_view>

namespace patchlight {
namespace {

constexpr std::size_t kFirstChunk = 12;  // after RIFF, the size of the file, and WEBP
constexpr std::size_t kChunkHeader = 8;  // name and size
constexpr unsigned char kAnimation = 2;  // flags of VP8X
constexpr unsigned char kAlpha = 16;
constexpr std::size_t kLosslessFlags = kChunkHeader + 4;  // from the start of VP8L
constexpr unsigned char kLosslessAlpha = 16;

bool has_text(std::span<const unsigned char> bytes, std::size_t at, std::string_view text) {
  return bytes.size() >= at + text.size() && std::equal(text.begin(), text.end(), bytes.begin() + std::ptrdiff_t(at));
}

/// A little-endian number; bytes beyond the end count as 0.
std::int64_t number(std::span<const unsigned char> bytes, std::size_t at, std::size_t size) {
  std::int64_t result = 0;
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i) result |= std::int64_t{bytes[at + i]} << (8 * i);
  return result;
}

/// Calls `visit(at)` for each chunk, which begins at `at` and may end beyond the bytes.
template <class Visit>
void each_chunk(std::span<const unsigned char> bytes, const Visit& visit) {
  for (std::size_t at = kFirstChunk; at + kChunkHeader < bytes.size();) {
    visit(at);
    const auto size = static_cast<std::size_t>(number(bytes, at + 4, 4));
    at += kChunkHeader + size + size % 2;
  }
}

}  // namespace

bool is_webp(std::span<const unsigned char> bytes) {
  return has_text(bytes, 0, "RIFF") && has_text(bytes, 8, "WEBP");
}

WebpHeader webp_header(std::span<const unsigned char> bytes) {
  WebpHeader header;
  each_chunk(bytes, [&](std::size_t at) {
    std::int64_t width = 0, height = 0;
    const std::size_t data = at + kChunkHeader;
    if (has_text(bytes, at, "VP8X")) {
      header.is_animated = (number(bytes, data, 1) & kAnimation) != 0;
      width = number(bytes, data + 4, 3) + 1;
      height = number(bytes, data + 7, 3) + 1;
    } else if (has_text(bytes, at, "VP8L")) {
      header.has_alpha = (number(bytes, at + kLosslessFlags, 1) & kLosslessAlpha) != 0;
      const std::int64_t sides = number(bytes, data + 1, 4);
      width = sides % 16384 + 1;
      height = sides / 16384 % 16384 + 1;
    } else if (has_text(bytes, at, "VP8 ")) {
      width = number(bytes, data + 6, 2) % 16384;
      height = number(bytes, data + 8, 2) % 16384;
    } else if (has_text(bytes, at, "ALPH")) {
      header.has_alpha = true;
    }
    header.width = std::max(header.width, width);
    header.height = std::max(header.height, height);
  });
  return header;
}

std::vector<unsigned char> webp_without_alpha(std::span<const unsigned char> bytes) {
  std::vector<unsigned char> result(bytes.begin(), bytes.end());
  const auto clear = [&](std::size_t at, unsigned char flag) {
    if (at < result.size()) result[at] &= static_cast<unsigned char>(~flag);
  };
  each_chunk(bytes, [&](std::size_t at) {
    if (has_text(bytes, at, "VP8X")) clear(at + kChunkHeader, kAlpha);
    if (has_text(bytes, at, "VP8L")) clear(at + kLosslessFlags, kLosslessAlpha);
    if (has_text(bytes, at, "ALPH")) result[at] = 'X';  // a chunk of an unknown name is skipped
  });
  return result;
}

}  // namespace patchlight
