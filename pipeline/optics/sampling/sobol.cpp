#include "pipeline/optics/sampling/sobol.h"

#include <bit>

namespace patchlight {

namespace {

/// [bit of the index][dimension]
using DirectionNumbers = std::array<std::array<std::uint32_t, 4>, 32>;

/// Sets the direction numbers of a dimension from the degree s and inner coefficients a of its primitive polynomial
/// and its initial numbers m.
constexpr void set_dimension(DirectionNumbers& v, int d, int s, std::uint32_t a,
                             const std::array<std::uint32_t, 3>& m) {
  for (int i = 0; i < 32; ++i) {
    if (i < s) {
      v[i][d] = m[i] << (31 - i);
      continue;
    }
    v[i][d] = v[i - s][d] ^ (v[i - s][d] >> s);
    for (int k = 1; k < s; ++k) v[i][d] ^= (a >> (s - 1 - k) & 1u) * v[i - k][d];
  }
}

constexpr DirectionNumbers kDirectionNumbers = [] {
  DirectionNumbers v{};
  for (int i = 0; i < 32; ++i) v[i][0] = 1u << (31 - i);
  set_dimension(v, 1, 1, 0, {1, 0, 0});
  set_dimension(v, 2, 2, 1, {1, 3, 0});
  set_dimension(v, 3, 3, 1, {1, 3, 1});
  return v;
}();

}  // namespace

std::array<std::uint32_t, 4> sobol4(std::uint32_t index) {
  std::array<std::uint32_t, 4> point{};
  for (; index != 0; index &= index - 1) {
    const auto& number = kDirectionNumbers[std::countr_zero(index)];
    for (int k = 0; k < 4; ++k) point[k] ^= number[k];
  }
  return point;
}

}  // namespace patchlight
