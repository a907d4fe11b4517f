#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "pipeline/optics/sampling/random.h"

namespace patchlight {

/// Owen scrambling of a number in reversed bit order: each bit is flipped or kept by a hash of all lower bits, which
/// are the higher ones of the reversed number (Laine and Karras 2011, with the constants of Vegdahl 2021).
inline std::uint32_t owen_scrambled(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adea;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56;
  x ^= x * 0x53a22864;
  return x;
}

/// Shuffled index of a sample: a permutation that keeps aligned blocks of 1, 2, 4, ... indices together. It
/// decorrelates the points that one sample takes from two sequences (Burley 2020, section 4).
inline std::uint32_t shuffled(std::uint32_t k, std::uint32_t seed) {
  return reverse_bits(owen_scrambled(reverse_bits(k), seed));
}

/// Second Sobol dimension at k, in reversed bit order; the first dimension in reversed bit order is k itself.
constexpr std::uint32_t sobol_second(std::uint32_t k) {
  std::uint32_t second = 0;
  for (std::uint32_t column = 1; k != 0; k >>= 1, column ^= column << 1)
    if (k & 1u) second ^= column;
  return second;
}

/// sobol_second() of the first 64 indices.
inline constexpr auto kSobolSecond = [] {
  std::array<std::uint32_t, 64> values{};
  for (std::uint32_t k = 0; k < values.size(); ++k) values[k] = sobol_second(k);
  return values;
}();

/// Point k of a pixel's samples in [0,1)^2: the first two Sobol dimensions, Owen-scrambled. Every prefix of 4, 16, 64,
/// ... points is stratified along both axes and in squares, so samples can be added progressively.
inline Vec2f pixel_sample(std::uint32_t k, std::uint64_t seed) {
  const std::uint32_t second = k < kSobolSecond.size() ? kSobolSecond[k] : sobol_second(k);
  const std::uint32_t x = reverse_bits(owen_scrambled(k, std::uint32_t(seed)));
  const std::uint32_t y = reverse_bits(owen_scrambled(second, std::uint32_t(seed >> 32)));
  return {float(x >> 8) * 0x1p-24f, float(y >> 8) * 0x1p-24f};
}

/// A point of the unit disc for a point of the unit square; keeps areas and neighbours (Shirley and Chiu 1997).
inline Vec2f concentric_disc(const Vec2f& at) {
  const float x = 2 * at.x - 1, y = 2 * at.y - 1;
  if (x == 0 && y == 0) return Vec2f(0.0f);
  const bool wide = std::abs(x) > std::abs(y);
  const float radius = wide ? x : y, quarter = float(kPi / 4);
  const float angle = wide ? quarter * (y / x) : quarter * (2 - x / y);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Point of the lens, a unit disc, for sample k of a pixel with the `seed` of its pixel_sample(). As evenly spread as
/// the points of the pixel, and independent of them.
inline Vec2f lens_sample(std::uint32_t k, std::uint64_t seed) {
  constexpr std::uint64_t kLens = 0x6c656e73;  // another sequence than those of reflections
  const std::uint64_t lens_seed = hash64(seed ^ kLens);
  return concentric_disc(pixel_sample(shuffled(k, std::uint32_t(hash64(lens_seed))), lens_seed));
}

}  // namespace patchlight
