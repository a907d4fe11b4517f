#include "importers/patches/patch_cuts.h"

#include <gtest/gtest.h>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// Cuts patches of one target area, m2.
void cut(double patch_area, PatchSet& scene) {
  cut_patches(std::vector<PatchTarget>(scene.primitives.size(), {patch_area}), scene);
}

/// A floor of 16 x 16 m in 8 x 8 patches with a wall across it at x, turned about the vertical, and a triangular one.
PatchScene floor_with_wall(double x, double turn) {
  PatchScene builder;
  builder.quad({{{-8, 0, -8}, {-8, 0, 8}, {8, 0, 8}, {8, 0, -8}}}, 8, 8, {});
  builder.quad({{{-8, 0, -8}, {-8, 0, 8}, {8, 0, 8}, {8, 0, 8}}}, 6, 6, {});
  const Vec3d at(x, 0, 0), along(std::sin(turn), 0, std::cos(turn)), up(0, 3, 0);
  builder.quad({{at - along * 4.0, at + along * 4.0, at + along * 4.0 + up, at - along * 4.0 + up}}, 4, 4, {});
  return builder;
}

double area_of_primitive(const PatchSet& scene, std::int32_t i) {
  double area = 0;
  for (const Patch& patch : scene.patches) area += patch.primitive == i ? patch.area : 0;
  return area;
}

TEST(PatchCuts, LeaveNoPatchOnBothSidesOfAWall) {
  for (const double turn : {0.0, 0.4, 1.2}) {
    PatchScene builder = floor_with_wall(0.3, turn);
    PatchSet& scene = builder.get();
    const double before = area_of_primitive(scene, 0);
    const std::size_t patches = scene.patches.size();
    cut(4, scene);
    EXPECT_GE(scene.patches.size(), patches + 4);
    EXPECT_NEAR(area_of_primitive(scene, 0), before, 1e-9 * before);
    const Vec3d across(std::cos(turn), 0, -std::sin(turn)), along(std::sin(turn), 0, std::cos(turn));
    const PatchLookup lookup(scene);
    for (std::int32_t i = 0; i < std::int32_t(scene.patches.size()); ++i) {
      const Patch& patch = scene.patches[i];
      if (patch.primitive > 1) continue;
      const PatchSampler sampler(scene.primitives, patch);
      double left = 0, right = 0;
      for (float a = 0.02f; a < 1; a += 0.05f)
        for (float b = 0.02f; b < 1; b += 0.05f) {
          const Vec3d at = sampler(a, b).position - Vec3d(0.3, 0, 0);
          const Imath::V2d uv = sampler.place(a, b).uv;
          ASSERT_EQ(lookup.patch(patch.primitive, float(uv.x), float(uv.y)), i) << at;
          if (std::abs(at ^ along) > 4) continue;
          left = std::max(left, -(at ^ across));
          right = std::max(right, at ^ across);
        }
      EXPECT_LT(std::min(left, right), 1e-5) << i;
    }
  }
}

TEST(PatchCuts, InTheLastRowAloneAreFound) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0}}}, 4, 4, {});  // u along z, v along x
  builder.quad({{{3.4, 0, 0}, {3.4, 0, 4}, {3.4, 1, 4}, {3.4, 1, 0}}}, 1, 1, {});
  PatchSet& scene = builder.get();
  cut(1, scene);
  ASSERT_EQ(scene.patches.size(), 16 + 4 + 1u);
  const PatchLookup lookup(scene);
  ASSERT_EQ(lookup.rows(0), 4);
  for (int row = 0; row < 4; ++row) EXPECT_EQ(lookup.row(0, row).cells, 4);
  for (float u = 0.05f; u < 1; u += 0.1f)
    for (float v = 0.025f; v < 1; v += 0.05f) {
      const Patch& patch = scene.patches[lookup.patch(0, u, v)];
      EXPECT_TRUE(patch.u0 <= u && u <= patch.u1 && patch.v0 <= v && v <= patch.v1);
      EXPECT_EQ(patch.center.x > 3.4, v > 0.85f);
    }
}

TEST(PatchCuts, MarkEdgesBetweenTilesOnWhichAWallStands) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0}}}, 4, 4, {});
  builder.quad({{{8, 0, 0}, {4, 0, 0}, {4, 0, 4}, {8, 0, 4}}}, 4, 4, {});
  builder.quad({{{4, 0, 0}, {4, 0, 2}, {4, 1, 2}, {4, 1, 0}}}, 2, 1, {});
  PatchSet& scene = builder.get();
  cut(1, scene);
  int closed = 0;
  for (const Patch& patch : scene.patches) {
    if (patch.closed == 0) continue;
    ++closed;
    EXPECT_TRUE(std::abs(patch.center.x - 4) < 1 && patch.center.z < 2 && patch.center.y == 0);
  }
  EXPECT_EQ(closed, 4);
}

TEST(PatchCuts, SampleTheirPartsUniformly) {
  PatchScene builder = floor_with_wall(0.3, 0.4);
  PatchSet& scene = builder.get();
  cut(4, scene);
  for (const Patch& patch : scene.patches) {
    if (patch.triangles.empty()) continue;
    const PatchSampler sampler(scene.primitives, patch);
    Vec3d mean(0.0);
    constexpr int kAcross = 64;
    for (int k = 0; k < kAcross * kAcross; ++k)
      mean += sampler((float(k % kAcross) + 0.5f) / kAcross, (float(k / kAcross) + 0.5f) / kAcross).position;
    EXPECT_LT((mean / (kAcross * kAcross) - patch.center).length(), 0.01 * std::sqrt(patch.area)) << "the centroid";
  }
}

TEST(PatchCuts, MarkEdgesOnWhichAWallStands) {
  PatchScene builder = floor_with_wall(2, 0);  // along the edges of patches
  PatchSet& scene = builder.get();
  const std::size_t patches = scene.patches.size();
  cut(4, scene);
  const PatchLookup lookup(scene);
  EXPECT_EQ(lookup.rows(0), 8);
  EXPECT_FALSE(lookup.is_open(0, 3, 4)) << "u runs along z, v along x";
  EXPECT_FALSE(lookup.is_open(0, 2, 4));
  EXPECT_TRUE(lookup.is_open(0, 3, 3));
  EXPECT_TRUE(lookup.is_open(0, 0, 4)) << "past the end of the wall";
  EXPECT_TRUE(scene.patches.size() > patches) << "the triangle is cut";
}

TEST(PatchCuts, DependOnShapesAlone) {
  PatchScene plain = floor_with_wall(0.3, 0.4), lit = floor_with_wall(0.3, 0.4);
  for (Patch& patch : lit.get().patches) patch.reflectance = Color(0.9f), patch.emission = Color(patch.primitive == 0);
  lit.get().primitives[0].light_group = 0;
  cut(4, plain.get());
  cut(4, lit.get());
  ASSERT_EQ(plain.get().patches.size(), lit.get().patches.size());
  EXPECT_EQ(plain.get().cuts.size(), lit.get().cuts.size());
  lit = floor_with_wall(0.3, 0.4);
  lit.get().primitives[0].emission_texture = 0;
  cut(4, lit.get());
  EXPECT_LT(lit.get().patches.size(), plain.get().patches.size()) << "a picture's patches are lamps";
}

TEST(PatchCuts, LeaveSmallSurfacesAndSmallThingsOut) {
  PatchScene builder;
  builder.quad({{{-8, 0, -8}, {-8, 0, 8}, {8, 0, 8}, {8, 0, -8}}}, 8, 8, {});
  builder.quad({{{0, 0, 0}, {0.2, 0, 0.2}, {0.2, 1, 0.2}, {0, 1, 0}}}, 1, 1, {});
  const std::size_t patches = builder.get().patches.size();
  cut(4, builder.get());
  EXPECT_EQ(builder.get().patches.size(), patches);
}

}  // namespace
}  // namespace patchlight
