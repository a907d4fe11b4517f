#include "solver/direction_table.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "pipeline/optics/random.h"

namespace patchlight {

namespace {

std::uint32_t morton(float x, float y) {
  const auto i = std::uint32_t(x * 65536.0f), j = std::uint32_t(y * 65536.0f);
  std::uint32_t code = 0;
  for (int bit = 0; bit < 16; ++bit) code |= (i >> bit & 1u) << (2 * bit) | (j >> bit & 1u) << (2 * bit + 1);
  return code;
}

}  // namespace

DirectionTable::DirectionTable(int count) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  const auto radius = [&](std::uint32_t k) { return (float(k) + 0.5f) / float(count); };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return morton(radius(a), radical_inverse(a)) < morton(radius(b), radical_inverse(b));
  });
  for (const std::uint32_t k : order) {
    const Vec2f start = kronecker2(k, 0);
    x.push_back(radius(k));
    y.push_back(radical_inverse(k));
    u.push_back(start.x);
    v.push_back(start.y);
  }
}

}  // namespace patchlight
