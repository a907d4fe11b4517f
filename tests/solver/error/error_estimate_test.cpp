#include "solver/error/error_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/solve.h"
#include "tests/random_room.h"

namespace patchlight {
namespace {

using test::PatchScene;

EnergyField solve_quietly(const PatchSet& scene, const SolveConfig& config) {
  Progress progress({"test", true, ""});
  return solve(scene, config, progress);
}

SolveConfig config_of(int rays, double tolerance) {
  SolveConfig config;
  config.rays = rays;
  config.tolerance = tolerance;
  config.display = false;
  return config;
}

/// Two rooms, joined under the ceiling, and a lamp in the first.
PatchScene two_bright_rooms(float reflectance) {
  PatchScene builder;
  builder.room(1, 6, {reflectance});
  builder.quad({{{-0.01, -1, -1}, {-0.01, -1, 1}, {-0.01, 0.6, 1}, {-0.01, 0.6, -1}}}, 4, 4, {reflectance});
  builder.quad({{{0.01, -1, -1}, {0.01, 0.6, -1}, {0.01, 0.6, 1}, {0.01, -1, 1}}}, 4, 4, {reflectance});
  builder.sphere({-0.5, 0, 0}, 0.2, 4, 6, {0.0f, 1.0f});
  return builder;
}

TEST(ErrorEstimate, AmplifiesTheResidualAsTheSystemDoes) {
  for (const float reflectance : {0.5f, 0.9f, 0.995f})
    for (const double tolerance : {0.1, 0.01}) {
      PatchScene builder = two_bright_rooms(reflectance);
      const EnergyField energy = solve_quietly(builder.get(), config_of(128, tolerance));
      const EnergyField exact = solve_quietly(builder.get(), config_of(128, 1e-9));  // of the same rows
      const double error = radiosity_error(builder.get(), energy, exact);
      EXPECT_NEAR(energy.estimate->error_residual / error, 1.0, 0.15) << reflectance << ", " << tolerance;
      EXPECT_LT(exact.estimate->error_residual, 1e-5);
    }
}

TEST(ErrorEstimate, LocalErrorIsNotHiddenByABrightYard) {
  PatchScene builder = two_bright_rooms(0.6f);  // closed, beside a yard under the sky
  builder.quad({{{-4, -1.5, 4}, {-2, -1.5, 4}, {-2, -1.5, 2}, {-4, -1.5, 2}}}, 8, 8, {0.8f});
  PatchSet& scene = builder.get();
  scene.environment.emplace();
  scene.environment->texels.assign(1, Color(100.0f));
  scene.environment->cells.assign(1, Color(100.0f));
  const EnergyField energy = solve_quietly(scene, config_of(64, 1e-3)),
                    truth = solve_quietly(scene, config_of(8192, 1e-6));
  const double global = radiosity_error(scene, energy, truth), local = local_radiosity_error(scene, energy, truth);
  EXPECT_LE(global, energy.estimate->error_bound);
  EXPECT_LT(energy.estimate->error_bound, 0.05);
  EXPECT_GT(local, 0.1);
  EXPECT_LE(local, energy.estimate->error_local);
  EXPECT_LT(energy.estimate->error_local, 2 * local);
}

TEST(ErrorEstimate, ATargetLowersTheToleranceBeforeItCastsMoreRays) {
  PatchScene builder = two_bright_rooms(0.995f);
  SolveConfig config = config_of(1024, 0.1);
  const EnergyField rough = solve_quietly(builder.get(), config);
  config.error_target = 0.04;
  config.tolerance = 0.1;
  const EnergyField energy = solve_quietly(builder.get(), config);
  EXPECT_GT(rough.estimate->error_residual, 0.04);
  EXPECT_LE(energy.estimate->error_bound, 0.04);
  EXPECT_EQ(energy.rays, rough.rays);
}

/// The bounds, global and local, hold as often as stated, over rooms of all kinds; and they are no empty ones.
TEST(ErrorEstimate, HoldsInRandomRooms) {
  constexpr int kRooms = 24;
  int within = 0, within_locally = 0;
  std::vector<double> ratios, local_ratios;
  for (int k = 0; k < kRooms; ++k) {
    test::RandomRoom room(std::uint64_t(1000 + k));
    room.config.rays = std::min(room.config.rays, 256);
    SolveConfig exact = room.exact();
    exact.rays = 4096;
    const EnergyField energy = solve_quietly(room.scene(), room.config), truth = solve_quietly(room.scene(), exact);
    const double error = radiosity_error(room.scene(), energy, truth),
                 local = local_radiosity_error(room.scene(), energy, truth);
    ASSERT_GT(error, 0) << "room " << k;
    within += error <= energy.estimate->error_bound;
    within_locally += local <= energy.estimate->error_local;
    ratios.push_back(energy.estimate->error_bound / error);
    local_ratios.push_back(energy.estimate->error_local / local);
  }
  EXPECT_GE(within, 21);  // 23 expected; fewer than 21 has a probability of 3%
  EXPECT_GE(within_locally, 21);
  for (std::vector<double>* list : {&ratios, &local_ratios}) {
    std::sort(list->begin(), list->end());
    EXPECT_LT((*list)[kRooms / 2], 2);
  }
}

}  // namespace
}  // namespace patchlight
