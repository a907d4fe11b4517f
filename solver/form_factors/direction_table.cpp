#include "solver/form_factors/direction_table.h"

#include <algorithm>
#include <bit>

#include "pipeline/optics/sampling/morton.h"
#include "pipeline/optics/sampling/sobol.h"

namespace patchlight {

DirectionTable::DirectionTable(int count) {
  std::vector<std::array<std::uint32_t, 4>> points;
  for (int k = 0; k < count; ++k) points.push_back(sobol4(std::uint32_t(k)));
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
  return sobol4(index * std::bit_ceil(std::uint32_t(count())));
}

}  // namespace patchlight
