#include "solver/form_factors/ray_form_factors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr std::uint32_t kRays = 1 << 20;
// Four standard errors of a million independent rays at F = 0.2; the sequence does several times better.
constexpr double kTolerance = 1.6e-3;

std::array<Vec3d, 4> square(double z, bool up) {
  return up ? std::array<Vec3d, 4>{{{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}}}
            : std::array<Vec3d, 4>{{{0, 0, z}, {0, 1, z}, {1, 1, z}, {1, 0, z}}};
}

/// Fraction of patch i's rays that hit primitive `target`; -1: rays that hit nothing.
double form_factor(const PatchSet& scene, std::int32_t i, std::int32_t target) {
  const RayFormFactors factors(scene, 1);
  const Shot shot{i, kRays, 0};
  std::size_t hits = 0;
  for (const std::int32_t j : factors.cast({&shot, 1})) hits += (j < 0 ? -1 : scene.patches[j].primitive) == target;
  return double(hits) / kRays;
}

TEST(RayFormFactors, ParallelSquaresMatchTheClosedForm) {
  PatchScene builder;
  builder.quad(square(0, true), 1, 1, {});
  builder.quad(square(1, false), 5, 5, {});
  EXPECT_NEAR(form_factor(builder.get(), 0, 1), 0.199824895698387, kTolerance);
}

TEST(RayFormFactors, PerpendicularSquaresMatchTheClosedForm) {
  PatchScene builder;
  builder.quad(square(0, true), 1, 1, {});
  builder.quad({{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}}, 3, 4, {});
  EXPECT_NEAR(form_factor(builder.get(), 0, 1), 0.200043776075403, kTolerance);
}

TEST(RayFormFactors, ConcentricSpheresMatchTheClosedForm) {
  PatchScene builder;
  builder.sphere({5, 6, 7}, 0.5, 1, 1, {});
  builder.sphere({5, 6, 7}, -1, 1, 1, {});
  EXPECT_EQ(form_factor(builder.get(), 0, 1), 1.0);
  EXPECT_NEAR(form_factor(builder.get(), 1, 0), 0.25, kTolerance);
  EXPECT_NEAR(form_factor(builder.get(), 1, 1), 0.75, kTolerance);
  EXPECT_EQ(form_factor(builder.get(), 1, -1), 0.0);
}

TEST(RayFormFactors, PatchesInsideASphereSeeEachOtherByArea) {
  PatchScene builder;
  builder.sphere({0, 0, 0}, -2, 4, 3, {});
  const PatchSet& scene = builder.get();
  const RayFormFactors factors(scene, 1);
  const Shot shot{4, kRays, 0};
  std::vector<double> row(scene.patches.size());
  for (const std::int32_t j : factors.cast({&shot, 1})) {
    ASSERT_GE(j, 0);
    row[j] += 1.0 / kRays;
  }
  for (std::size_t j = 0; j < row.size(); ++j)
    EXPECT_NEAR(row[j], scene.patches[j].area / (16 * kPi), kTolerance) << j;  // 4 pi R^2, the shooter's own included
}

TEST(RayFormFactors, SphereAboveASquareMatchesTheClosedForm) {
  PatchScene builder;
  builder.quad({{{-0.5, 0, 0.5}, {0.5, 0, 0.5}, {0.5, 0, -0.5}, {-0.5, 0, -0.5}}}, 1, 1, {});
  builder.sphere({0, 0.5, 0}, 0.4, 1, 1, {});
  EXPECT_NEAR(form_factor(builder.get(), 1, 0), 1.0 / 6, kTolerance);
}

TEST(RayFormFactors, TwoTrianglesMatchTheSquareTheyForm) {
  // The form factor of the unit square is the mean of its two triangles'.
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}}}, 1, 1, {});
  builder.quad({{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  builder.quad(square(1, false), 1, 1, {});
  EXPECT_NEAR((form_factor(builder.get(), 0, 2) + form_factor(builder.get(), 1, 2)) / 2, 0.199824895698387, kTolerance);
}

TEST(RayFormFactors, RowsSumToOneInAClosedBox) {
  for (const double size : {1e-3, 1.0, 1e3}) {
    PatchScene builder;
    builder.room(size, 2, {});
    const RayFormFactors factors(builder.get(), 1);
    std::vector<Shot> shots;
    for (int i = 0; i < 24; ++i) shots.push_back({i, 1 << 15, 0});
    std::size_t lost = 0;
    for (const std::int32_t j : factors.cast(shots)) lost += j < 0;
    EXPECT_LE(lost, 1u) << "of 786,432 rays in a box of size " << size;
  }
}

TEST(RayFormFactors, NoRayPassesAThinWall) {
  PatchScene builder;
  builder.room(1, 2, {});
  // A wall of 0.1 mm across the whole room, with patches on both its sides.
  builder.quad({{{-1, -1, 0}, {-1, 1, 0}, {1, 1, 0}, {1, -1, 0}}}, 2, 2, {});
  builder.quad({{{-1, -1, 1e-4}, {1, -1, 1e-4}, {1, 1, 1e-4}, {-1, 1, 1e-4}}}, 2, 2, {});
  const PatchSet& scene = builder.get();
  const RayFormFactors factors(scene, 1);
  for (std::int32_t i = 0; i < std::int32_t(scene.patches.size()); ++i) {
    if (scene.patches[i].primitive != 4 && scene.patches[i].primitive != 6) continue;  // only patches behind the wall
    const Shot shot{i, 1 << 14, 0};
    for (const std::int32_t j : factors.cast({&shot, 1})) {
      const bool behind = j < 0 || scene.patches[j].center.z < 5e-5;
      ASSERT_TRUE(behind) << i << " reaches " << j;
    }
  }
}

TEST(RayFormFactors, ShotsContinueTheSequenceOfThePatch) {
  PatchScene builder;
  builder.room(1, 3, {});
  const RayFormFactors factors(builder.get(), 1);
  const std::vector<Shot> whole{{7, 64, 0}}, parts{{7, 16, 0}, {7, 48, 16}};
  EXPECT_EQ(factors.cast(whole), factors.cast(parts));
}

}  // namespace
}  // namespace patchlight
