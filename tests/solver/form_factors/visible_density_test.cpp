#include "solver/form_factors/visible_density.h"

#include <gtest/gtest.h>

#include "pipeline/optics/sampling/random.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr std::uint64_t kRandom = 7;

VisibleDensity density_of(const PatchSet& scene, std::size_t patch) {
  return {scene, RayScene(scene), scene.patches[patch], kRandom};
}

/// A floor of 1 m2 with a block on it from (x0,z0) to (x1,z1).
PatchScene floor_with_block(double x0, double x1, double z0, double z1) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 1, 1, {});
  builder.quad({{{x1, 0, z0}, {x1, 1, z0}, {x1, 1, z1}, {x1, 0, z1}}}, 1, 1, {});
  builder.quad({{{x0, 1, z0}, {x0, 1, z1}, {x1, 1, z1}, {x1, 1, z0}}}, 1, 1, {});
  builder.quad({{{x0, 0, z1}, {x1, 0, z1}, {x1, 1, z1}, {x0, 1, z1}}}, 1, 1, {});
  builder.quad({{{x0, 0, z0}, {x0, 1, z0}, {x1, 1, z0}, {x1, 0, z0}}}, 1, 1, {});
  builder.quad({{{x0, 0, z0}, {x0, 0, z1}, {x0, 1, z1}, {x0, 1, z0}}}, 1, 1, {});
  return builder;
}

TEST(VisibleDensity, LeavesOutTheAreaUnderABlock) {
  const auto visible = [](double x0, double x1, double z0, double z1) {
    return density_of(floor_with_block(x0, x1, z0, z1).get(), 0).visible_fraction();
  };
  EXPECT_NEAR(visible(-1, 0.3, 0, 1), 0.7, 0.02) << "one border";
  EXPECT_NEAR(visible(-1, 0.3, -1, 0.6), 1 - 0.3 * 0.6, 0.03) << "a corner";
  EXPECT_NEAR(visible(0.3, 0.7, 0.2, 0.7), 1 - 0.4 * 0.5, 0.03) << "in the middle";
  EXPECT_EQ(visible(1.5, 1.7, 0.2, 0.7), 1.0f) << "beside it";
}

TEST(VisibleDensity, StartsNoRayUnderABlock) {
  const VisibleDensity density = density_of(floor_with_block(-1, 0.25, 0, 1).get(), 0);
  double mean = 0;
  for (int k = 0; k < 1024; ++k) {
    const Vec2f at = density(Vec2f((float(k % 32) + 0.5f) / 32, (float(k / 32) + 0.5f) / 32));
    EXPECT_GE(at.y, 0.24f);
    mean += at.y / 1024;
  }
  EXPECT_NEAR(mean, 0.625, 0.01);
}

TEST(VisibleDensity, LeavesOutTheFloorOutsideOfARoom) {
  PatchScene builder;
  builder.room(1, 2, {});
  const int floor = builder.quad({{{0, -0.9, -1}, {0, -0.9, 1}, {4, -0.9, 1}, {4, -0.9, -1}}}, 1, 1, {});
  const PatchSet& scene = builder.get();
  const auto first = std::find_if(scene.patches.begin(), scene.patches.end(),
                                  [&](const Patch& patch) { return patch.primitive == floor; });
  EXPECT_NEAR(density_of(scene, std::size_t(first - scene.patches.begin())).visible_fraction(), 0.25, 0.03);
}

TEST(VisibleDensity, IsInProportionToTheOpennessBehindAPanel) {
  PatchScene builder;  // a floor under a sky; on its left, the back of a panel is above it
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {2, 0, 1}, {2, 0, 0}}}, 1, 1, {});
  builder.quad({{{-4, 0.5, -4}, {-4, 0.5, 5}, {1, 0.5, 5}, {1, 0.5, -4}}}, 1, 1, {});
  builder.quad({{{-99, 9, -99}, {99, 9, -99}, {99, 9, 99}, {-99, 9, 99}}}, 1, 1, {});
  const VisibleDensity density = density_of(builder.get(), 0);
  double far_under = 0, aside = 0;
  for (int k = 0; k < 1 << 14; ++k) {
    const Vec2f at = density(kronecker2(std::uint64_t(k), 0));
    far_under += at.y < 0.25f;
    aside += at.y > 0.75f;
  }
  EXPECT_NEAR(far_under / aside, 0.0978, 0.03) << "means of (1 - sin) / 2 and (1 + sin) / 2, by the edge's angle";
}

}  // namespace
}  // namespace patchlight
