#include "pipeline/model/energy_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

TEST(WeightedPercentile, CountsWeightsNotValues) {
  const std::vector<std::pair<double, double>> values{{3, 1}, {1, 8}, {2, 1}};
  EXPECT_EQ(weighted_percentile(values, 0.8), 1);
  EXPECT_EQ(weighted_percentile(values, 0.85), 2);
  EXPECT_EQ(weighted_percentile(values, 0.95), 3);
  EXPECT_EQ(weighted_percentile(values, 1), 3);
  EXPECT_EQ(weighted_percentile({}, 0.5), 0);
}

/// A bright and a dark square of 40 patches each, and a lamp.
struct BrightAndDark {
  test::PatchScene builder;
  EnergyField energy;

  BrightAndDark() {
    builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 8, 5, {0.5f});
    builder.quad({{{2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0}}}, 8, 5, {0.5f});
    builder.quad({{{4, 0, 0}, {5, 0, 0}, {5, 1, 0}, {4, 1, 0}}}, 1, 1, {0.5f, 1.0f});
    energy.groups = {{"light", std::vector<Color>(81, Color(100.0f)), std::vector<Color>(81, Color(0.0f))}};
    std::fill_n(energy.groups[0].direct.begin() + 40, 40, Color(1.0f));
  }
};

TEST(LocalRadiosityError, IsNotHiddenByABrightPlace) {
  const BrightAndDark exact;
  BrightAndDark wrong;
  for (std::size_t i = 40; i < 80; ++i) wrong.energy.groups[0].direct[i] *= 1.25f;
  const PatchSet& scene = wrong.builder.get();
  EXPECT_LT(radiosity_error(scene, wrong.energy, exact.energy), 0.003);
  EXPECT_NEAR(local_radiosity_error(scene, wrong.energy, exact.energy), 0.25, 1e-6);
}

TEST(LocalRadiosityError, LeavesOutEmittersAndATwentiethOfTheArea) {
  const BrightAndDark exact;
  BrightAndDark wrong;
  PatchSet& scene = wrong.builder.get();
  wrong.energy.groups[0].direct[80] *= 2.0f;
  for (std::size_t i = 0; i < 3; ++i) wrong.energy.groups[0].direct[i] *= 2.0f;
  EXPECT_EQ(local_radiosity_error(scene, wrong.energy, exact.energy), 0);
  for (std::size_t i = 3; i < 5; ++i) wrong.energy.groups[0].direct[i] *= 2.0f;
  EXPECT_NEAR(local_radiosity_error(scene, wrong.energy, exact.energy), 1, 1e-6);
  for (std::size_t i = 0; i < 5; ++i) scene.patches[i].reflectance = Color(0.0f);
  EXPECT_EQ(local_radiosity_error(scene, wrong.energy, exact.energy), 0) << "black patches reflect nothing";
}

TEST(LocalRadiosityError, LeavesOutWhatIsBlackInBothSolutions) {
  BrightAndDark exact, wrong;
  std::fill_n(exact.energy.groups[0].direct.begin() + 40, 40, Color(1e-8f));
  std::fill_n(wrong.energy.groups[0].direct.begin() + 40, 40, Color(3e-8f));
  const PatchSet& scene = wrong.builder.get();
  EXPECT_EQ(local_radiosity_error(scene, wrong.energy, exact.energy), 0);
  std::fill_n(wrong.energy.groups[0].direct.begin() + 40, 40, Color(1.0f));
  EXPECT_GT(local_radiosity_error(scene, wrong.energy, exact.energy), 1e6) << "a leak";
}

TEST(LocalRadiosityError, IsInfiniteWhereOnlyTheReferenceIsBlack) {
  BrightAndDark exact;
  const BrightAndDark wrong;
  PatchSet scene = exact.builder.get();
  std::fill_n(exact.energy.groups[0].direct.begin(), 40, Color(0.0f));
  EXPECT_TRUE(std::isinf(local_radiosity_error(scene, wrong.energy, exact.energy)));
  EXPECT_EQ(local_radiosity_error(scene, exact.energy, exact.energy), 0);
}

}  // namespace
}  // namespace patchlight
