#pragma once
#include <array>
#include <cstdint>

#include "pipeline/model/math.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {

/// Point `index` of the four-dimensional Sobol sequence (Joe and Kuo 2008): each coordinate as 32 bits of a number in
/// [0,1).
std::array<std::uint32_t, 4> sobol4(std::uint32_t index);

/// 32 bits as a number in [0,1).
inline float unit_float(std::uint32_t bits) {
  return float(std::int32_t(bits >> 8)) * 0x1p-24f;
}

/// Pairs of points of the unit square, stratified jointly: for a ray's two ends. The Sobol sequence, with a random
/// digital shift (Kollig and Keller 2002). Two sequences of two dimensions, each with a shift of its own, are no
/// substitute: what they leave out of four dimensions can cost more than random numbers do.
class PointPairs {
 public:
  explicit PointPairs(std::uint64_t random) {
    for (int k = 0; k < 4; ++k) shift_[k] = std::uint32_t(hash64(random + std::uint64_t(k / 2)) >> 32 * (k % 2));
  }

  struct Pair {
    Vec2f from, to;
  };
  Pair operator()(std::uint32_t index) const {
    std::array<std::uint32_t, 4> x = sobol4(index);
    for (int k = 0; k < 4; ++k) x[k] ^= shift_[k];
    return {{unit_float(x[0]), unit_float(x[1])}, {unit_float(x[2]), unit_float(x[3])}};
  }

 private:
  std::array<std::uint32_t, 4> shift_;
};

}  // namespace patchlight
