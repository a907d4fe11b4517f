#include "tracer/light/solution/irradiance_lookup.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// Patch means of a linear function of position.
std::vector<Color> linear_values(const PatchSet& scene) {
  std::vector<Color> values;
  for (const Patch& patch : scene.patches) values.emplace_back(float(10 + 3 * patch.center.x + 2 * patch.center.y));
  return values;
}

IrradianceLookup lookup_of(const PatchSet& scene, const PatchLookup& patches, const std::vector<Color>& values) {
  return {scene, patches, SmoothEdges(scene.primitives), [&](std::size_t) { return values; }, {{Color(1.0f)}}};
}

TEST(IrradianceLookup, FollowsALinearFunctionUpToTheEdges) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 5, 3, {});
  const PatchLookup patches(builder.get());
  const std::vector<Color> values = linear_values(builder.get());
  const IrradianceLookup lookup = lookup_of(builder.get(), patches, values);
  for (float u : {0.0f, 0.03f, 0.5f, 0.97f, 1.0f})
    for (float v : {0.0f, 0.1f, 0.5f, 1.0f}) EXPECT_NEAR(lookup(0, u, v).x, 10 + 3 * u + 2 * v, 1e-4) << u << " " << v;
}

TEST(IrradianceLookup, ExtrapolatesNoDarkerThanBlack) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 2, 1, {});
  const PatchLookup patches(builder.get());
  const std::vector<Color> values{Color(0.1f), Color(9.0f)};
  EXPECT_EQ(lookup_of(builder.get(), patches, values)(0, 0, 0.5f).x, 0.05f);
}

/// Two squares side by side along x, the second folded a little; `smooth`: they share the vertices of their common
/// edge.
PatchScene two_squares(int cells, bool smooth, double fold = 0.1) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, cells, cells, {});
  builder.quad({{{1, 0, 0}, {2, 0, fold}, {2, 1, fold}, {1, 1, 0}}}, cells, cells, {});
  builder.get().primitives[0].smooth_vertices = {0, 1, 2, 3};
  builder.get().primitives[1].smooth_vertices = smooth ? std::array{1, 4, 5, 2} : std::array{6, 4, 5, 7};
  return builder;
}

TEST(IrradianceLookup, IsContinuousAcrossASmoothEdgeAndBreaksAtACrease) {
  for (const int cells : {1, 4})
    for (const bool smooth : {true, false}) {
      PatchScene builder = two_squares(cells, smooth);
      const PatchLookup patches(builder.get());
      std::vector<Color> values(builder.get().patches.size(), Color(1.0f));
      for (std::size_t i = values.size() / 2; i < values.size(); ++i) values[i] = Color(5.0f);
      const IrradianceLookup lookup = lookup_of(builder.get(), patches, values);
      const float left = lookup(0, 1.0f, 0.4f).x, right = lookup(1, 0.0f, 0.4f).x;
      if (smooth) {
        EXPECT_NEAR(left, 3.0f, 1e-5) << cells;
        EXPECT_NEAR(right, 3.0f, 1e-5) << cells;
      } else {
        EXPECT_EQ(left, 1.0f);
        EXPECT_EQ(right, 5.0f);
      }
    }
}

TEST(IrradianceLookup, IsContinuousAcrossAnEdgeOfOnePlane) {
  for (const int cells : {1, 4}) {
    PatchScene builder = two_squares(cells, false, 0);
    const PatchLookup patches(builder.get());
    const std::vector<Color> values = linear_values(builder.get());
    const IrradianceLookup lookup = lookup_of(builder.get(), patches, values);
    EXPECT_NEAR(lookup(0, 1.0f, 0.5f).x, 14, 1e-4);
    EXPECT_NEAR(lookup(1, 0.0f, 0.5f).x, 14, 1e-4);
  }
}

TEST(IrradianceLookup, FollowsALinearFunctionAcrossASmoothEdge) {
  PatchScene builder = two_squares(4, true);
  const PatchLookup patches(builder.get());
  const std::vector<Color> values = linear_values(builder.get());
  const IrradianceLookup lookup = lookup_of(builder.get(), patches, values);
  EXPECT_NEAR(lookup(0, 0.99f, 0.5f).x, 10 + 3 * 0.99 + 1, 1e-4);
  EXPECT_NEAR(lookup(1, 0.01f, 0.5f).x, 10 + 3 * 1.01 + 1, 1e-4);
}

TEST(IrradianceLookup, OnSpheresWrapsInUAndNotInV) {
  PatchScene builder;
  builder.sphere({0, 0, 0}, 1, 6, 8, {});
  const PatchSet& scene = builder.get();
  const PatchLookup patches(scene);
  std::vector<Color> values;
  for (const Patch& patch : scene.patches) values.emplace_back(float(2 + patch.normal.x + 3 * patch.normal.y));
  const IrradianceLookup lookup = lookup_of(scene, patches, values);
  EXPECT_EQ(lookup(0, 0.0f, 0.5f).x, lookup(0, 1.0f, 0.5f).x);
  // At a pole every u gives one value, and the poles differ.
  for (const float u : {0.0f, 0.3f, 0.8f}) {
    EXPECT_NEAR(lookup(0, u, 0.0f).x, lookup(0, 0.5f, 0.0f).x, 1e-5);
    EXPECT_NEAR(lookup(0, u, 1.0f).x, lookup(0, 0.5f, 1.0f).x, 1e-5);
  }
  EXPECT_GT(lookup(0, 0.5f, 0.0f).x, 4.5f);
  EXPECT_LT(lookup(0, 0.5f, 1.0f).x, -0.5f);
}

}  // namespace
}  // namespace patchlight
