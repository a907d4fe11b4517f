#include "importers/patches/patch_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/importers/patches/primitive_shapes.h"

namespace patchlight::test {
namespace {

std::vector<Patch> patches_of(const Primitive& primitive, double patch_area) {
  std::vector<Patch> patches;
  append_patches(primitive, 0, {}, {patch_area}, patches);
  EXPECT_EQ(static_cast<double>(patches.size()), patch_count(primitive, patch_area));
  return patches;
}

double sum_of_areas(const std::vector<Patch>& patches) {
  double area = 0.0;
  for (const Patch& patch : patches) area += patch.area;
  return area;
}

TEST(PatchGrid, AreasSumToTheTrueArea) {
  for (const double patch_area : {1000.0, 1.0, 0.01, 0.0007}) {
    EXPECT_NEAR(sum_of_areas(patches_of(kRectangle, patch_area)), 4.0, 4e-12) << patch_area;
    EXPECT_NEAR(sum_of_areas(patches_of(kTrapezoid, patch_area)), 6.0, 6e-12) << patch_area;
    EXPECT_NEAR(sum_of_areas(patches_of(kTriangle, patch_area)), 6.0, 6e-12) << patch_area;
    EXPECT_NEAR(sum_of_areas(patches_of(sphere(2), patch_area)), 16 * kPi, 1e-11) << patch_area;
    EXPECT_NEAR(sum_of_areas(patches_of(sphere(-2), patch_area)), 16 * kPi, 1e-11) << patch_area;
  }
}

TEST(PatchGrid, PatchesOfATwistedQuadSumToItsArea) {
  const Primitive twisted = quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}}});
  const double fine = sum_of_areas(patches_of(twisted, 1e-5));
  EXPECT_NEAR(primitive_area(twisted), fine, 1e-4 * fine);
  EXPECT_NEAR(sum_of_areas(patches_of(twisted, 1e-3)), fine, 1e-8 * fine);
}

TEST(PatchGrid, PatchesHaveAboutTheRequestedArea) {
  EXPECT_EQ(patches_of(kRectangle, 0.01).size(), 400u);
  EXPECT_NEAR(static_cast<double>(patches_of(sphere(2), 0.01).size()), 16 * kPi / 0.01, 0.02 * 16 * kPi / 0.01);
}

TEST(PatchGrid, PatchAreaAboveThePrimitivesGivesTheFewestPatches) {
  EXPECT_EQ(patches_of(kRectangle, 1e9).size(), 1u);
  EXPECT_EQ(patches_of(sphere(2), 1e9).size(), 6u);
  EXPECT_EQ(patches_of(kTriangle, 3.1).size(), 1u);
}

TEST(PatchGrid, RowsTileTheUnitSquare) {
  for (const Primitive& primitive : {kRectangle, kTriangle, sphere(1)}) {
    const std::vector<Patch> patches = patches_of(primitive, 0.013);
    std::size_t next = 0;
    for (float v = 0; v != 1;) {
      const float v1 = patches.at(next).v1;
      for (float u = 0; u != 1; ++next) {
        ASSERT_EQ(patches.at(next).u0, u);
        ASSERT_EQ(patches.at(next).v0, v);
        ASSERT_EQ(patches.at(next).v1, v1);
        u = patches[next].u1;
      }
      v = v1;
    }
    EXPECT_EQ(next, patches.size());
  }
}

TEST(PatchGrid, CentresAndNormalsLieOnTheSphere) {
  for (const double radius : {2.0, -2.0}) {
    for (const Patch& patch : patches_of(sphere(radius), 0.5)) {
      const double phi = kPi * (double(patch.u0) + patch.u1);
      const double theta = kPi * (double(patch.v0) + patch.v1) / 2;
      const Vec3d out(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
      EXPECT_NEAR((patch.center - (Vec3d(1, 2, 3) + 2.0 * out)).length(), 0.0, 1e-12);
      EXPECT_NEAR(Vec3d(patch.normal).dot(out), radius > 0 ? 1.0 : -1.0, 1e-6);
    }
  }
}

TEST(PatchGrid, QuadCentresAreBilinear) {
  const Patch patch = patches_of(kTrapezoid, 100.0).at(0);
  EXPECT_NEAR((patch.center - Vec3d(2, 1, 0)).length(), 0.0, 1e-12);
  EXPECT_EQ(patch.normal, Vec3f(0, 0, 1));
}

TEST(PatchGrid, HugeAndTinyPrimitivesKeepTheirAreas) {
  for (const double scale : {1e-6, 1e6}) {
    Primitive triangle = kTriangle;
    for (Vec3d& corner : triangle.corners) corner *= scale;
    EXPECT_NEAR(sum_of_areas(patches_of(triangle, 0.01 * scale * scale)) / (6.0 * scale * scale), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace patchlight::test
