#include "pipeline/optics/sampling/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace patchlight {
namespace {

TEST(PointPairs, AreStratifiedInEveryPairOfDimensions) {
  constexpr int kSide = 8;
  const PointPairs pairs(7);
  std::array<std::array<std::set<int>, 4>, 4> cells;
  for (std::uint32_t k = 0; k < kSide * kSide; ++k) {
    const auto [from, to] = pairs(k);
    const std::array<float, 4> x{from.x, from.y, to.x, to.y};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) cells[i][j].insert(int(x[i] * kSide) * kSide + int(x[j] * kSide));
  }
  EXPECT_EQ(cells[0][1].size(), kSide * kSide);  // the first two dimensions are a (0,6,2)-net
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) EXPECT_GE(cells[i][j].size(), kSide * kSide / 2) << i << " " << j;
}

/// Relative RMS error of 160 pairs for the part of a pair's space where two sums of coordinates exceed limits, as for a
/// shadow's edge, with the coordinates in the order of `from[2 i]`.
double edge_error(const std::array<int, 4>& order) {
  constexpr int kPairs = 160, kSeeds = 200;
  constexpr double kExact = 0.125 * 0.125;  // P(a + b > 1.5)^2
  double squares = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const PointPairs pairs(std::uint64_t(seed) * 977);
    int inside = 0;
    for (std::uint32_t k = 0; k < kPairs; ++k) {
      const auto [from, to] = pairs(k);
      const std::array<float, 4> x{from.x, from.y, to.x, to.y};
      inside += x[order[0]] + x[order[1]] > 1.5f && x[order[2]] + x[order[3]] > 1.5f;
    }
    squares += std::pow(inside / double(kPairs) / kExact - 1, 2);
  }
  return std::sqrt(squares / kSeeds);
}

TEST(PointPairs, HaveLessErrorThanRandomNumbersForAnyPairOfDimensions) {
  const double random = std::sqrt((1 - 0.015625) / 0.015625 / 160);  // 63%
  for (const std::array<int, 4>& order : {std::array{0, 2, 1, 3}, std::array{0, 3, 1, 2}, std::array{0, 1, 2, 3}})
    EXPECT_LT(edge_error(order), 0.75 * random);
}

}  // namespace
}  // namespace patchlight
