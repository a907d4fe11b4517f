// After the appendices of KHR_meshopt_compression. meshoptimizer decodes version 1 and COLOR from its release 0.23 on.
#include "importers/gltf/model/meshopt_attributes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace patchlight {
namespace {

constexpr unsigned char kVersion1 = 0xa1;
constexpr std::size_t kGroup = 16;      // elements
constexpr std::size_t kMaxBlock = 256;  // elements
constexpr std::size_t kMaxBlockBytes = 8192;
constexpr std::size_t kMaxStride = 256;
constexpr std::size_t kMinTail = 24;                                              // bytes
constexpr std::array<std::array<int, 4>, 2> kBits{{{0, 1, 2, 4}, {1, 2, 4, 8}}};  // by control mode and header bits

/// A stream's bytes before its tail. Reading beyond them gives 0 and marks them as damaged.
struct ByteStream {
  std::span<const unsigned char> bytes;
  std::size_t at = 0;
  bool intact = true;

  unsigned char next() {
    if (at < bytes.size()) return bytes[at++];
    intact = false;
    return 0;
  }
  void next(std::span<unsigned char> values) {
    for (unsigned char& value : values) value = next();
  }
};

/// Two bits of packed ones.
int two_bits(std::span<const unsigned char> packed, std::size_t i) {
  return packed[i / 4] >> (2 * (i % 4)) & 3;
}

/// Reads the codes of one group. A code of fewer than 8 bits that are all set stands for one in a byte of its own.
void read_group(ByteStream& stream, int bits, std::span<unsigned char, kGroup> codes) {
  if (bits == 0) std::fill(codes.begin(), codes.end(), static_cast<unsigned char>(0));
  if (bits == 8) stream.next(codes);
  if (bits == 0 || bits == 8) return;
  std::array<unsigned char, kGroup / 2> packed{};
  stream.next(std::span(packed).first(static_cast<std::size_t>(2 * bits)));
  const int per_byte = 8 / bits, all_set = (1 << bits) - 1;
  for (int i = 0; i < static_cast<int>(kGroup); ++i) {
    const int place = bits == 1 ? i % 8 : per_byte - 1 - i % per_byte;  // single bits are stored from the least one on
    const int code = packed[static_cast<std::size_t>(i / per_byte)] >> (bits * place) & all_set;
    codes[static_cast<std::size_t>(i)] = code == all_set ? stream.next() : static_cast<unsigned char>(code);
  }
}

/// Reads the codes of a block: those of byte k of all elements at codes[k * kMaxBlock].
void read_block(ByteStream& stream, std::size_t stride, std::size_t count, std::span<unsigned char> codes) {
  std::array<unsigned char, kMaxStride / 4> controls{};
  stream.next(std::span(controls).first(stride / 4));
  const std::size_t groups = (count + kGroup - 1) / kGroup;
  for (std::size_t k = 0; k < stride; ++k) {
    const std::span<unsigned char> row = codes.subspan(k * kMaxBlock, kMaxBlock);
    const int control = two_bits(controls, k);
    if (control == 2) std::fill(row.begin(), row.end(), static_cast<unsigned char>(0));
    if (control == 3) stream.next(row.first(count));
    if (control >= 2) continue;
    std::array<unsigned char, kMaxBlock / kGroup / 4> headers{};
    stream.next(std::span(headers).first((groups + 3) / 4));
    for (std::size_t group = 0; group < groups; ++group)
      read_group(stream, kBits[static_cast<std::size_t>(control)][static_cast<std::size_t>(two_bits(headers, group))],
                 row.subspan(group * kGroup).first<kGroup>());
  }
}

/// Adds zigzag codes of 8 or 16 bits to the numbers of as many bits in `previous`, each with wraparound.
std::uint32_t added(std::uint32_t previous, std::uint32_t codes, int bits) {
  const std::uint32_t mask = bits == 8 ? 0xff : 0xffff;
  std::uint32_t result = 0;
  for (int shift = 0; shift < 32; shift += bits) {
    const std::uint32_t code = codes >> shift & mask;
    const std::uint32_t difference = (code & 1) != 0 ? ~(code >> 1) : code >> 1;
    result |= (((previous >> shift) + difference) & mask) << shift;
  }
  return result;
}

std::uint32_t next_value(std::uint32_t previous, std::uint32_t codes, int mode) {
  if (mode % 16 == 2) return previous ^ std::rotr(codes, mode / 16);
  return added(previous, codes, mode == 0 ? 8 : 16);
}

bool is_mode(int mode) {
  return mode == 0 || mode == 1 || mode % 16 == 2;
}

template <class Unsigned, class Signed>
bool decode_colors(std::span<unsigned char> elements) {
  constexpr int largest = (1 << 8 * sizeof(Unsigned)) - 1;
  for (std::size_t at = 0; at + 4 * sizeof(Unsigned) <= elements.size(); at += 4 * sizeof(Unsigned)) {
    std::array<Unsigned, 4> color;
    std::memcpy(color.data(), &elements[at], sizeof(color));
    const int alpha = color[3];
    if (alpha == 0) return false;
    const int one = (1 << std::bit_width(static_cast<unsigned>(alpha))) - 1;  // the highest bit of alpha says it
    const int y = color[0], co = static_cast<Signed>(color[1]), cg = static_cast<Signed>(color[2]);
    const std::array<int, 4> decoded{y + co - cg, y + cg, y - co - cg, (alpha << 1 & one) | (alpha & 1)};
    for (std::size_t i = 0; i < 4; ++i)
      color[i] =
          static_cast<Unsigned>(std::lround(static_cast<double>(std::clamp(decoded[i], 0, one)) * largest / one));
    std::memcpy(&elements[at], color.data(), sizeof(color));
  }
  return true;
}

}  // namespace

bool is_attributes_version_1(std::span<const unsigned char> compressed) {
  return !compressed.empty() && compressed[0] == kVersion1;
}

bool decode_attributes_version_1(const MeshoptView& view, std::span<const unsigned char> compressed,
                                 std::span<unsigned char> elements) {
  const std::size_t words = view.stride / 4, tail = std::max(view.stride + words, kMinTail);
  if (!is_attributes_version_1(compressed) || compressed.size() < 1 + tail) return false;
  const std::span<const unsigned char> modes = compressed.last(words);
  if (!std::all_of(modes.begin(), modes.end(), is_mode)) return false;
  std::vector<std::uint32_t> values(words);  // of the previous element; first the baseline
  std::memcpy(values.data(), compressed.last(view.stride + words).data(), view.stride);

  ByteStream stream{compressed.subspan(1, compressed.size() - 1 - tail)};
  std::vector<unsigned char> codes(view.stride * kMaxBlock);
  const std::size_t block = std::min(kMaxBlockBytes / view.stride / kGroup * kGroup, kMaxBlock);
  for (std::size_t begin = 0; begin < view.count && stream.intact; begin += block) {
    const std::size_t count = std::min(block, view.count - begin);
    read_block(stream, view.stride, count, codes);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < words; ++k) {
        std::uint32_t code = 0;
        for (std::size_t byte = 0; byte < 4; ++byte)
          code |= std::uint32_t{codes[(4 * k + byte) * kMaxBlock + i]} << (8 * byte);
        values[k] = next_value(values[k], code, modes[k]);
      }
      std::memcpy(&elements[(begin + i) * view.stride], values.data(), view.stride);
    }
  }
  return stream.intact && stream.at == stream.bytes.size();
}

bool decode_colors(const MeshoptView& view, std::span<unsigned char> elements) {
  return view.stride == 4 ? decode_colors<std::uint8_t, std::int8_t>(elements)
                          : decode_colors<std::uint16_t, std::int16_t>(elements);
}

}  // namespace patchlight
