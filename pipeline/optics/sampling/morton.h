#pragma once
#include <cstdint>

namespace patchlight {

/// Interleaves the bits of two 16-bit numbers (Morton 1966): points with close codes are close to each other.
inline std::uint32_t morton_code(std::uint32_t x, std::uint32_t y) {
  const auto spread_bits = [](std::uint32_t b) {
    b = (b | b << 8) & 0x00ff00ffu;
    b = (b | b << 4) & 0x0f0f0f0fu;
    b = (b | b << 2) & 0x33333333u;
    return (b | b << 1) & 0x55555555u;
  };
  return spread_bits(x) | spread_bits(y) << 1;
}

}  // namespace patchlight
