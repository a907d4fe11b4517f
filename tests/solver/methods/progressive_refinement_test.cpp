#include "solver/methods/progressive_refinement.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "solver/solve.h"
#include "tests/expect_error.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

EnergyField solve_quietly(const PatchSet& scene, const SolveConfig& config) {
  Progress progress({"test", true, ""});
  return solve(scene, config, progress);
}

SolveConfig config_of(int rays, double tolerance = 1e-4) {
  SolveConfig config;
  config.method = "progressive";
  config.display = false;
  config.rays = rays;
  config.tolerance = tolerance;
  return config;
}

double mean_radiosity(const PatchSet& scene, const EnergyField& energy) {
  const std::vector<Color> b = radiosity(scene, energy);
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    sum += double(b[i].y) * scene.patches[i].area;
    area += scene.patches[i].area;
  }
  return sum / area;
}

TEST(ProgressiveRefinement, FurnaceReachesItsClosedForm) {
  for (const float rho : {0.0f, 0.5f, 0.9f}) {
    PatchScene builder;
    builder.room(1, 6, {rho, 1.0f});
    const EnergyField energy = solve_quietly(builder.get(), config_of(1024));
    EXPECT_NEAR(mean_radiosity(builder.get(), energy) * (1 - rho), 1.0, 1e-3) << rho;
    for (const Color& b : radiosity(builder.get(), energy)) EXPECT_NEAR(b.y * (1 - rho), 1.0, 0.05) << rho;
  }
}

TEST(ProgressiveRefinement, SphereSeenFromInsideIsAFurnace) {
  PatchScene builder;
  builder.sphere({1, 2, 3}, -1, 8, 12, {0.8f, 2.0f});
  const EnergyField energy = solve_quietly(builder.get(), config_of(1024));
  EXPECT_NEAR(mean_radiosity(builder.get(), energy), 10.0, 0.02);
}

TEST(ProgressiveRefinement, CubeWithOneHotFaceMatchesTheClosedForm) {
  PatchScene builder;
  builder.room(0.5, 1, {0.5f, 0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[0].light_group = 0;
  scene.patches[0].emission = Color(1.0f);
  const EnergyField energy = solve_quietly(scene, config_of(1 << 18, 1e-5));
  const std::vector<Color> b = radiosity(scene, energy);
  EXPECT_NEAR(b[0].y, 1.090909098, 1e-3);
  EXPECT_NEAR(b[1].y, 0.181745826, 1e-3);
  for (int side = 2; side < 6; ++side) EXPECT_NEAR(b[side].y, 0.181836269, 1e-3);
}

TEST(ProgressiveRefinement, DirectLightExcludesReflections) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {0.5f, 3.0f});
  builder.quad({{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}}, 1, 1, {0.5f, 0.0f});
  const EnergyField energy = solve_quietly(builder.get(), config_of(1 << 18, 1e-6));
  const double f = 0.199824895698387;
  EXPECT_NEAR(energy.groups[0].direct[1].y, 3 * f, 3e-3);
  EXPECT_EQ(energy.groups[0].direct[0].y, 0);
  EXPECT_NEAR(energy.groups[0].indirect[0].y, 3 * f * 0.5 * f / (1 - 0.25 * f * f), 3e-3);
}

TEST(ProgressiveRefinement, ByHemicubesAndByRaysAgree) {
  PatchScene builder;
  builder.room(1, 6, {0.7f, 0.0f});
  builder.sphere({0, -0.6, 0}, 0.4, 4, 8, {0.4f, 0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[3].light_group = 0;
  scene.patches[3 * 36 + 14].emission = Color(5.0f);
  SolveConfig config = config_of(1 << 14);
  const EnergyField rays = solve_quietly(scene, config);
  config.form_factors = "hemicube";
  const EnergyField hemicubes = solve_quietly(scene, config);
  double difference = 0, norm = 0;
  const std::vector<Color> a = radiosity(scene, rays), b = radiosity(scene, hemicubes);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (scene.patches[i].emission != Color(0.0f)) continue;
    difference += scene.patches[i].area * std::pow(a[i].y - b[i].y, 2);
    norm += scene.patches[i].area * a[i].y * a[i].y;
  }
  EXPECT_LT(std::sqrt(difference / norm), 0.03);
  EXPECT_EQ(hemicubes.rays, 0);
}

TEST(ProgressiveRefinement, RaysOfASmallLampAreProportionalToItsPower) {
  PatchScene builder;
  builder.room(1, 40, {0.0f, 0.0f});
  builder.quad({{{-0.01, 0.9, -0.01}, {0.01, 0.9, -0.01}, {0.01, 0.9, 0.01}, {-0.01, 0.9, 0.01}}}, 1, 1, {0.0f, 1.0f});
  const EnergyField energy = solve_quietly(builder.get(), config_of(1024));
  EXPECT_GE(energy.rays, std::int64_t(1024 * builder.get().patches.size()));
}

TEST(ProgressiveRefinement, DimGroupsAreNoNoisierThanBrightOnes) {
  PatchScene builder;
  builder.room(1, 4, {0.6f, 0.0f});
  PatchSet& scene = builder.get();
  scene.light_groups = {"bright", "dim"};
  scene.primitives[0].light_group = 0;
  scene.primitives[1].light_group = 1;
  scene.patches[0].emission = Color(1e6f);
  scene.patches[20].emission = Color(1e-6f);
  const EnergyField energy = solve_quietly(scene, config_of(2048));
  // By symmetry both groups light the room alike, except for their strength.
  Vec3d sums(0.0);
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    sums.x += scene.patches[i].area * energy.groups[0].indirect[i].y / 1e6;
    sums.y += scene.patches[i].area * energy.groups[1].indirect[i].y / 1e-6;
  }
  EXPECT_NEAR(sums.y / sums.x, 1.0, 0.02);
}

TEST(ProgressiveRefinement, AnswersDoNotDependOnTheScaleOfEmissionOrSpace) {
  PatchScene unit, tiny;
  unit.room(1, 4, {0.5f, 1.0f});
  tiny.room(1e-3, 4, {0.5f, 1e-6f});
  const double a = mean_radiosity(unit.get(), solve_quietly(unit.get(), config_of(256)));
  const double b = mean_radiosity(tiny.get(), solve_quietly(tiny.get(), config_of(256)));
  EXPECT_NEAR(b * 1e6 / a, 1.0, 1e-3);
}

TEST(ProgressiveRefinement, GivesTheSameBitsForAnyNumberOfThreads) {
  PatchScene builder;
  builder.room(1, 5, {0.7f, 0.1f});
  builder.sphere({0, 0, 0}, 0.4, 6, 8, {0.5f, 0.0f});
  std::vector<EnergyField> fields;
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    fields.push_back(solve_quietly(builder.get(), config_of(128)));
  }
  for (const EnergyField& field : fields) {
    EXPECT_EQ(field.groups[0].direct, fields[0].groups[0].direct);
    EXPECT_EQ(field.groups[0].indirect, fields[0].groups[0].indirect);
    EXPECT_EQ(field.rays, fields[0].rays);
  }
}

TEST(ProgressiveRefinement, SceneWithoutLightIsBlack) {
  PatchScene builder;
  builder.room(1, 2, {});
  builder.get().light_groups.clear();
  const EnergyField energy = solve_quietly(builder.get(), config_of(64));
  EXPECT_TRUE(energy.groups.empty());
  EXPECT_EQ(energy.residual, 0.0);
  EXPECT_EQ(energy.rays, 0);
  EXPECT_EQ(mean_radiosity(builder.get(), energy), 0.0);
}

TEST(ProgressiveRefinement, StopsAtTheShotLimitAtReflectancesNearOne) {
  PatchScene builder;
  builder.room(1, 2, {0.99999f, 1.0f});
  SolveConfig config = config_of(64);
  config.max_shots = 50;
  ::testing::internal::CaptureStderr();
  const EnergyField energy = solve_quietly(builder.get(), config);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("solve.max_shots"));
  EXPECT_LT(energy.iterations, 24 * 50 + 64);
  EXPECT_GT(energy.residual, config.tolerance);
}

TEST(Solve, RefusesAnOddHemicube) {
  PatchScene builder;
  builder.room(1, 1, {});
  SolveConfig config;
  config.form_factors = "hemicube";
  config.hemicube_resolution = 65;
  EXPECT_ERROR(solve_quietly(builder.get(), config), ExitCode::bad_config, "solve.hemicube_resolution");
}

}  // namespace
}  // namespace patchlight
