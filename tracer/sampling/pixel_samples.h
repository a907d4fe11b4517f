#pragma once
#include <array>
#include <cstdint>

#include "pipeline/optics/sampling/random.h"

namespace patchlight {

/// Bits of `x`, highest first, each flipped or not by a hash of those above it: Owen's scrambling (Laine and Karras
/// 2011, as improved by Vegdahl 2021), of a number whose bits are in the opposite order.
inline std::uint32_t owen_scrambled(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adea;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56;
  x ^= x * 0x53a22864;
  return x;
}

/// Another order of all numbers, in which aligned runs of 1, 2, 4, ... stay together: so that what one sample takes
/// from two sequences has nothing in common (Burley 2020, section 4).
inline std::uint32_t shuffled(std::uint32_t k, std::uint32_t seed) {
  return reversed_bits(owen_scrambled(reversed_bits(k), seed));
}

/// Sobol's second dimension at k, its bits in the opposite order, as k's own are in the first.
constexpr std::uint32_t sobol_second(std::uint32_t k) {
  std::uint32_t second = 0;
  for (std::uint32_t column = 1; k != 0; k >>= 1, column ^= column << 1)
    if (k & 1u) second ^= column;
  return second;
}

/// The same of the first numbers.
inline constexpr auto kSobolSecond = [] {
  std::array<std::uint32_t, 64> values{};
  for (std::uint32_t k = 0; k < values.size(); ++k) values[k] = sobol_second(k);
  return values;
}();

/// Place k of a pixel's samples, in [0,1)^2: Sobol's first two dimensions, scrambled. The first 4, 16, 64, ... are each
/// stratified in both axes and in squares, so that more samples go on from fewer.
inline Vec2f pixel_sample(std::uint32_t k, std::uint64_t seed) {
  const std::uint32_t second = k < kSobolSecond.size() ? kSobolSecond[k] : sobol_second(k);
  const std::uint32_t x = reversed_bits(owen_scrambled(k, std::uint32_t(seed)));
  const std::uint32_t y = reversed_bits(owen_scrambled(second, std::uint32_t(seed >> 32)));
  return {float(x >> 8) * 0x1p-24f, float(y >> 8) * 0x1p-24f};
}

}  // namespace patchlight
