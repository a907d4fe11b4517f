#include "solver/hemicube/hemicube.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "solver/form_factors/ray_form_factors.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// Row of patch i: the mean of `count` hemicubes.
std::vector<double> hemicube_row(const PatchSet& scene, std::int32_t i, int resolution, int count) {
  HemicubeFormFactors factors(scene, resolution, 1);
  std::vector<double> row(scene.patches.size());
  for (int k = 0; k < count; ++k) {
    const Shot shot{i, 0, std::uint64_t(k)};
    const std::span<const FormFactor> factors_of_shot = factors.rows({&shot, 1})[0];
    for (const FormFactor& f : factors_of_shot) row[f.patch] += double(f.value) / count;
  }
  return row;
}

double sum(const std::vector<double>& row) {
  return std::accumulate(row.begin(), row.end(), 0.0);
}

/// Sum over the patches of one primitive.
double sum_on(const PatchSet& scene, const std::vector<double>& row, std::int32_t primitive) {
  double total = 0;
  for (std::size_t j = 0; j < row.size(); ++j) total += scene.patches[j].primitive == primitive ? row[j] : 0.0;
  return total;
}

TEST(Hemicube, WeightsSumToOne) {
  for (const int n : {2, 64, 128}) {
    double total = 0;
    for (const float w : hemicube_weights(n)) total += w;
    EXPECT_NEAR(total, 1.0, 1e-5);
  }
}

TEST(Hemicube, FacesAreRightHandedViewsAboutTheNormal) {
  const Vec3f normal = Vec3f(1, 2, -2).normalized();
  for (const HemicubeFace& face : hemicube_faces(Vec3f(0), normal, 0.3f, 1, 8)) {
    EXPECT_LT((face.view.right % face.view.up + face.view.forward).length(), 1e-6f);
    EXPECT_NEAR(face.view.forward.length(), 1, 1e-6);
  }
}

TEST(Hemicube, RowsSumToOneInAClosedBoxAtAnyScale) {
  for (const double size : {1e-3, 1.0, 1e3}) {
    PatchScene builder;
    builder.room(size, 4, {});
    for (const std::int32_t i : {0, 5, 30, 90}) EXPECT_NEAR(sum(hemicube_row(builder.get(), i, 64, 1)), 1.0, 1e-5);
  }
}

TEST(Hemicube, ParallelSquaresMatchTheClosedForm) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  builder.quad({{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}}, 5, 5, {});
  EXPECT_NEAR(sum_on(builder.get(), hemicube_row(builder.get(), 0, 128, 256), 1), 0.199824895698387, 5e-4);
}

TEST(Hemicube, TouchingWallsMatchTheClosedForm) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  builder.quad({{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}}, 3, 4, {});
  EXPECT_NEAR(sum_on(builder.get(), hemicube_row(builder.get(), 0, 128, 256), 1), 0.200043776075403, 1e-3);
}

TEST(Hemicube, SpheresMatchTheClosedForms) {
  PatchScene builder;
  builder.sphere({5, 6, 7}, 0.5, 4, 6, {});
  builder.sphere({5, 6, 7}, -1, 6, 8, {});
  // F from the inner to the outer sphere is 1, back (r1/r2)^2.
  EXPECT_NEAR(sum_on(builder.get(), hemicube_row(builder.get(), 9, 128, 1), 1), 1.0, 1e-5);
  const std::vector<double> outer = hemicube_row(builder.get(), 24 + 20, 128, 8);
  EXPECT_NEAR(sum_on(builder.get(), outer, 0), 0.25, 1e-3);
  EXPECT_NEAR(sum_on(builder.get(), outer, 1), 0.75, 1e-3);
}

TEST(Hemicube, PatchesInsideASphereSeeEachOtherByArea) {
  PatchScene builder;
  builder.sphere({0, 0, 0}, -2, 4, 6, {});
  const PatchSet& scene = builder.get();
  const std::vector<double> row = hemicube_row(scene, 8, 128, 64);
  for (std::size_t j = 0; j < row.size(); ++j) EXPECT_NEAR(row[j], scene.patches[j].area / (16 * kPi), 1e-3) << j;
}

TEST(Hemicube, SphereAboveASquareMatchesTheClosedForm) {
  PatchScene builder;
  builder.quad({{{-0.5, 0, 0.5}, {0.5, 0, 0.5}, {0.5, 0, -0.5}, {-0.5, 0, -0.5}}}, 1, 1, {});
  builder.sphere({0, 0.5, 0}, 0.4, 1, 1, {});
  EXPECT_NEAR(sum_on(builder.get(), hemicube_row(builder.get(), 1, 128, 512), 0), 1.0 / 6, 3e-3);
}

TEST(Hemicube, SeesNothingThroughAThinWallOrAnUnlitBack) {
  PatchScene builder;
  builder.room(1, 2, {});
  builder.quad({{{-1, -1, 0}, {-1, 1, 0}, {1, 1, 0}, {1, -1, 0}}}, 2, 2, {});
  builder.quad({{{-1, -1, 1e-4}, {1, -1, 1e-4}, {1, 1, 1e-4}, {-1, 1, 1e-4}}}, 2, 2, {});
  const PatchSet& scene = builder.get();
  // A patch of the wall at -z. A GPU may leave a cell open between walls that share no vertices (seen on an H100).
  constexpr double kCell = 1e-4 / 8;
  const std::vector<double> row = hemicube_row(scene, 17, 64, 8);
  for (std::size_t j = 0; j < row.size(); ++j) {
    if (scene.patches[j].center.z > 5e-5) {
      EXPECT_LT(row[j], kCell) << j;
    }
  }
  EXPECT_NEAR(sum(row), 1.0, 2 * kCell);
}

TEST(Hemicube, AgreesWithRaysOnEveryKindOfSurface) {
  PatchScene builder;
  builder.room(1, 3, {});
  builder.sphere({0.3, -0.5, 0.1}, 0.3, 4, 6, {});
  builder.quad({{{-0.6, -0.4, -0.5}, {0.1, -0.4, -0.6}, {-0.2, 0.3, -0.4}, {-0.2, 0.3, -0.4}}}, 2, 2, {});
  builder.quad({{{-0.8, 0.5, 0.2}, {-0.8, 0.5, 0.8}, {-0.3, 0.5, 0.6}, {-0.4, 0.5, 0.3}}}, 2, 3, {});
  const PatchSet& scene = builder.get();
  RayFormFactors rays(scene, 1);
  for (const std::int32_t i : {4, 13, 30, 45, 60, 70, 80}) {
    const std::vector<double> hemicube = hemicube_row(scene, i, 128, 512);
    std::vector<double> cast(scene.patches.size());
    const Shot shot{i, 1 << 18, 0};
    const std::span<const FormFactor> factors = rays.rows({&shot, 1})[0];
    for (const FormFactor& f : factors) cast[f.patch] += f.value;
    for (std::size_t j = 0; j < cast.size(); ++j)
      EXPECT_NEAR(hemicube[j], cast[j], 0.006 * std::sqrt(cast[j]) + 2e-4) << i << " to " << j;
  }
}

}  // namespace
}  // namespace patchlight
