#include "tracer/sampling/pixel_samples.h"

#include <gtest/gtest.h>

#include <set>

namespace patchlight {
namespace {

TEST(PixelSamples, AreStratifiedInSquaresAndAlongBothAxesAtPowersOfFour) {
  for (std::uint64_t pixel = 0; pixel < 50; ++pixel)
    for (const int side : {2, 4, 8, 16}) {
      const int count = side * side;
      std::set<int> columns, rows, squares;
      for (int k = 0; k < count; ++k) {
        const Vec2f at = pixel_sample(std::uint32_t(k), hash64(pixel));
        ASSERT_TRUE(at.x >= 0 && at.x < 1 && at.y >= 0 && at.y < 1);
        columns.insert(int(at.x * float(count)));
        rows.insert(int(at.y * float(count)));
        squares.insert(int(at.x * float(side)) * side + int(at.y * float(side)));
      }
      EXPECT_EQ(int(columns.size()), count);
      EXPECT_EQ(int(rows.size()), count);
      EXPECT_EQ(int(squares.size()), count);
    }
}

TEST(PixelSamples, AreUniformOverPixels) {
  double x = 0, y = 0, product = 0;
  constexpr int kPixels = 20000;
  for (std::uint64_t pixel = 0; pixel < kPixels; ++pixel) {
    const Vec2f at = pixel_sample(0, hash64(pixel));
    x += at.x / kPixels;
    y += at.y / kPixels;
    product += (at.x - 0.5) * (at.y - 0.5) / kPixels;
  }
  EXPECT_NEAR(x, 0.5, 0.01);  // 5 standard deviations
  EXPECT_NEAR(y, 0.5, 0.01);
  EXPECT_NEAR(product, 0, 0.003);
}

}  // namespace
}  // namespace patchlight
