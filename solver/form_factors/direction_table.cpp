#include "solver/form_factors/direction_table.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "pipeline/optics/sampling/morton.h"

namespace patchlight {

namespace {

using DirectionNumbers = std::array<std::array<std::uint32_t, 32>, 4>;

/// Sets the direction numbers of a dimension from the degree s and inner coefficients a of its primitive polynomial
/// and its initial numbers m.
void set_dimension(std::array<std::uint32_t, 32>& v, int s, std::uint32_t a, const std::array<std::uint32_t, 3>& m) {
  for (int i = 0; i < 32; ++i) {
    if (i < s) {
      v[i] = m[i] << (31 - i);
      continue;
    }
    v[i] = v[i - s] ^ (v[i - s] >> s);
    for (int k = 1; k < s; ++k) v[i] ^= (a >> (s - 1 - k) & 1u) * v[i - k];
  }
}

const DirectionNumbers& direction_numbers() {
  static const DirectionNumbers numbers = [] {
    DirectionNumbers d{};
    for (int i = 0; i < 32; ++i) d[0][i] = 1u << (31 - i);
    set_dimension(d[1], 1, 0, {1, 0, 0});
    set_dimension(d[2], 2, 1, {1, 3, 0});
    set_dimension(d[3], 3, 1, {1, 3, 1});
    return d;
  }();
  return numbers;
}

std::array<std::uint32_t, 4> sobol(std::uint32_t index) {
  std::array<std::uint32_t, 4> point{};
  for (int dimension = 0; dimension < 4; ++dimension)
    for (int bit = 0; bit < 32; ++bit) point[dimension] ^= (index >> bit & 1u) * direction_numbers()[dimension][bit];
  return point;
}

}  // namespace

DirectionTable::DirectionTable(int count) {
  std::vector<std::array<std::uint32_t, 4>> points;
  for (int k = 0; k < count; ++k) points.push_back(sobol(std::uint32_t(k)));
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return morton_code(a[0] >> 16, a[1] >> 16) < morton_code(b[0] >> 16, b[1] >> 16);
  });
  for (const auto& p : points) {
    x.push_back(p[0]);
    y.push_back(p[1]);
    u.push_back(p[2]);
    v.push_back(p[3]);
  }
}

std::array<std::uint32_t, 4> DirectionTable::block(std::uint32_t index) const {
  return sobol(index * std::bit_ceil(std::uint32_t(count())));
}

}  // namespace patchlight
