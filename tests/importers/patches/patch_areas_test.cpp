#include "importers/patches/patch_areas.h"

#include <gtest/gtest.h>

#include <cmath>

#include "importers/patches/patch_grid.h"
#include "tests/expect_error.h"
#include "tests/importers/patches/primitive_shapes.h"

namespace patchlight::test {
namespace {

Primitive square(double side) {
  return quad({{{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}}});
}

TEST(PatchAreas, DefaultIsAnEightThousandthOfTheArea) {
  ImportConfig config;
  for (const double accuracy : {1.0, 0.25, 4.0}) {
    config.accuracy = accuracy;
    for (const double area : choose_patch_areas({kRectangle, sphere(1)}, {{}}, config))
      EXPECT_NEAR(area, (4.0 + 4 * kPi) / (8000 * accuracy), 1e-12);
  }
}

TEST(PatchAreas, FollowTheScaleOfASurface) {
  const Primitive ground = square(10'000), wall = square(4), coin = sphere(0.001);
  const std::vector<double> areas = choose_patch_areas({coin, wall, ground, wall, coin, coin}, {{}}, {});
  EXPECT_NEAR(areas[0] * 8000 / (3 * 4 * kPi * 1e-6), 1, 0.01);
  EXPECT_NEAR(areas[1] * 8000 / (2 * 16), 1, 0.01);
  EXPECT_NEAR(areas[2] * 8000 / (8 * 1e8), 1, 0.001) << "alone in its scale";
}

TEST(PatchAreas, HaveNoStepBetweenScales) {
  double before = 0;
  for (double side = 1; side < 30'000; side *= 1.05) {
    const double area = choose_patch_areas({square(1), square(side)}, {{}}, {})[0];
    EXPECT_LT(before > 0 ? std::abs(std::log(area / before)) : 0, 0.25) << side;
    before = area;
  }
  EXPECT_NEAR(before * 8000, 8, 0.1) << "alone in its scale";
}

TEST(PatchAreas, OfTheJobAndOfMaterialsApplyToAllScales) {
  ImportConfig config;
  config.patch_area = 0.5;
  std::vector<SurfaceMaterial> materials(2);
  materials[1].patch_area = 3;
  std::vector<Primitive> primitives{square(1), square(1000)};
  EXPECT_EQ(choose_patch_areas(primitives, materials, config), (std::vector{0.5, 0.5}));
  primitives[0].material = 1;
  EXPECT_EQ(choose_patch_areas(primitives, materials, config), (std::vector{3.0, 0.5}));
}

TEST(PatchAreas, TooManyPatchesNameTheLimitAndAnAreaThatFits) {
  ImportConfig config;
  config.patch_area = 1e-9;
  config.max_patches = 1000;
  EXPECT_ERROR(choose_patch_areas({kRectangle}, {{}}, config), ExitCode::over_limit, "import.max_patches");
  try {
    choose_patch_areas({kRectangle}, {{}}, config);
  } catch (const Error& error) {
    const std::string text = error.what();
    config.patch_area = std::stod(text.substr(text.find("patch_area of ") + 14));
    EXPECT_LE(patch_count(kRectangle, choose_patch_areas({kRectangle}, {{}}, config)[0]), 1000);
    EXPECT_GE(patch_count(kRectangle, *config.patch_area), 700);
  }
}

TEST(PatchAreas, DefaultGrowsUntilItFits) {
  ImportConfig config;
  config.max_patches = 100;
  EXPECT_LE(patch_count(kRectangle, choose_patch_areas({kRectangle}, {{}}, config)[0]), 100);
}

TEST(PatchAreas, MoreSurfacesThanPatchesAreRefused) {
  ImportConfig config;
  config.max_patches = 2;
  EXPECT_ERROR(choose_patch_areas({kRectangle, kTriangle, kTrapezoid}, {{}}, config), ExitCode::over_limit,
               "import.max_patches");
}

TEST(PatchAreas, AbsurdlySmallAreaIsRefusedAtOnce) {
  ImportConfig config;
  for (const double tiny : {1e-30, 1e-300}) {
    config.patch_area = tiny;
    EXPECT_ERROR(choose_patch_areas({kRectangle, sphere(1)}, {{}}, config), ExitCode::over_limit, "import.max_patches");
  }
}

}  // namespace
}  // namespace patchlight::test
