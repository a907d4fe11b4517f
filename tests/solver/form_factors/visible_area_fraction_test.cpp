#include "solver/form_factors/visible_area_fraction.h"

#include <gtest/gtest.h>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// Visible area fraction of a floor of 1 m2 with a block on it from (x0,z0) to (x1,z1).
float visible_floor(double x0, double x1, double z0, double z1, std::uint64_t random) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 1, 1, {});
  builder.quad({{{x1, 0, z0}, {x1, 1, z0}, {x1, 1, z1}, {x1, 0, z1}}}, 1, 1, {});
  builder.quad({{{x0, 1, z0}, {x0, 1, z1}, {x1, 1, z1}, {x1, 1, z0}}}, 1, 1, {});
  builder.quad({{{x0, 0, z1}, {x1, 0, z1}, {x1, 1, z1}, {x0, 1, z1}}}, 1, 1, {});
  builder.quad({{{x0, 0, z0}, {x0, 1, z0}, {x1, 1, z0}, {x1, 0, z0}}}, 1, 1, {});
  builder.quad({{{x0, 0, z0}, {x0, 0, z1}, {x0, 1, z1}, {x0, 1, z0}}}, 1, 1, {});
  const RayScene ray_scene(builder.get());
  std::int64_t cast = 0;
  for (std::size_t i = 1; i < 6; ++i)
    EXPECT_EQ(visible_area_fraction(builder.get(), ray_scene, builder.get().patches[i], 1024, random, cast), 1.0f);
  return visible_area_fraction(builder.get(), ray_scene, builder.get().patches[0], 1024, random, cast);
}

TEST(VisibleAreaFraction, IsThatOfTheUncoveredArea) {
  for (std::uint64_t random = 0; random < 8; ++random) {
    EXPECT_NEAR(visible_floor(-1, 0.3, 0, 1, random), 0.7, 0.01) << "one border";
    EXPECT_NEAR(visible_floor(-1, 0.3, -1, 0.6, random), 1 - 0.3 * 0.6, 0.025) << "a corner";
    EXPECT_NEAR(visible_floor(0.3, 0.7, 0.2, 0.7, random), 1 - 0.4 * 0.5, 0.03) << "in the middle";
    EXPECT_EQ(visible_floor(1.5, 1.7, 0.2, 0.7, random), 1.0f) << "beside it";
  }
}

}  // namespace
}  // namespace patchlight
