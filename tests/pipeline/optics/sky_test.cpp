#include "pipeline/optics/lights/sky.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patchlight {
namespace {

/// Texels hold their column and row.
Environment sky_of(int width, int height) {
  Environment sky;
  sky.width = width;
  sky.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) sky.texels.emplace_back(float(x), float(y), 1.0f);
  return sky;
}

TEST(Sky, IsOrientedAsInBlender) {
  const Environment sky = sky_of(8, 4);
  // Cycles: u = 1/2 - atan2(y, x) / 2 pi with Z up; Blender's x, y, z are glTF's x, -z, y.
  EXPECT_NEAR(texel_at(sky, {1, 0, 0}).x, 4, 1e-5) << "the middle";
  EXPECT_NEAR(texel_at(sky, {0, 0, -1}).x, 2, 1e-5) << "Blender's +Y";
  EXPECT_NEAR(texel_at(sky, {0, 0, 1}).x, 6, 1e-5);
  EXPECT_NEAR(texel_at(sky, {2, 0, 0}).y, 2, 1e-5);
  EXPECT_NEAR(texel_at(sky, {0, 3, 0}).y, 0, 1e-5) << "up";
  EXPECT_NEAR(texel_at(sky, {0, -1, 0}).y, 4, 1e-5);
}

TEST(Sky, RotatesCounterClockwiseFromAbove) {
  Environment sky = sky_of(8, 4);
  sky.turn = 0.25;  // the image centre moves from +X to -Z
  EXPECT_NEAR(texel_at(sky, {0, 0, -1}).x, 4, 1e-5);
}

TEST(Sky, DirectionsAndTexelsAreInverse) {
  Environment sky = sky_of(8, 4);
  sky.turn = -0.3;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      const Vec3f direction(direction_at(sky, x + 0.5, y + 0.5));
      EXPECT_NEAR(direction.length(), 1, 1e-6);
      EXPECT_NEAR(texel_at(sky, direction).x, float(x) + 0.5f, 1e-4);
      EXPECT_NEAR(texel_at(sky, direction).y, float(y) + 0.5f, 1e-4);
      EXPECT_NEAR(sky_radiance(sky, direction).x, x, 1e-3);
      EXPECT_NEAR(sky_radiance(sky, direction).y, y, 1e-3);
    }
}

TEST(Sky, IsClippedByItsLargestChannel) {
  Environment sky = sky_of(1, 1);
  sky.texels.assign(1, Color(8.0f, 4.0f, 0.0f));
  EXPECT_EQ(clipped_radiance(sky, {0, 1, 0}), Color(8.0f, 4.0f, 0.0f));
  sky.clip = 2.0f;
  EXPECT_EQ(clipped_radiance(sky, {0, 1, 0}), Color(2.0f, 1.0f, 0.0f));
}

TEST(Sky, CellsHaveEqualSolidAngle) {
  Environment sky = sky_of(1, 1);
  sky.rows = 3;
  sky.cells.resize(18);
  std::vector<int> counts(sky.cells.size());
  constexpr int kSide = 300;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {  // uniform over the sphere
      const double y = 1 - 2 * (j + 0.5) / kSide, turn = 2 * kPi * (i + 0.5) / kSide, r = std::sqrt(1 - y * y);
      ++counts.at(sky_cell(sky, Vec3f(float(r * std::cos(turn)), float(y), float(r * std::sin(turn))) * 3.0f));
    }
  for (const int count : counts) EXPECT_EQ(count, kSide * kSide / 18);
  EXPECT_EQ(sky_cell(sky, {0, 1, 0}) / 6, 0);
  EXPECT_EQ(sky_cell(sky, {0, -1, 0}) / 6, 2);
}

}  // namespace
}  // namespace patchlight
