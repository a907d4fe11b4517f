#pragma once
#include <cstdint>

#include "pipeline/model/math.h"

namespace patchlight {

/// Hash of a 64-bit number, a bijection: splitmix64 (Steele, Lea and Flood 2014).
inline std::uint64_t hash64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// The upper 24 bits as a number in [0,1).
inline float uniform01(std::uint64_t x) {
  return float(x >> 40) * 0x1p-24f;
}

/// Point k of the two-dimensional Kronecker sequence of the plastic number (R2), with a random shift from `shift`.
inline Vec2f kronecker2(std::uint64_t k, std::uint64_t shift) {
  return {uniform01(shift + k * 0xc13fa9a902a6328f), uniform01(hash64(shift) + k * 0x91e10da5c79e7b1d)};
}

/// The bits of x in reverse order.
inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = (x & 0xff00ff00u) >> 8 | (x & 0x00ff00ffu) << 8;
  x = (x & 0xf0f0f0f0u) >> 4 | (x & 0x0f0f0f0fu) << 4;
  x = (x & 0xccccccccu) >> 2 | (x & 0x33333333u) << 2;
  return (x & 0xaaaaaaaau) >> 1 | (x & 0x55555555u) << 1;
}

/// Element k of the van der Corput sequence in base 2, in [0,1).
inline float radical_inverse(std::uint32_t k) {
  return float(reverse_bits(k) >> 8) * 0x1p-24f;
}

/// (x + shift) mod 1, for x and shift in [0,1): a Cranley-Patterson rotation.
inline float shifted(float x, float shift) {
  const float sum = x + shift;
  return sum - float(sum >= 1.0f);
}

}  // namespace patchlight
