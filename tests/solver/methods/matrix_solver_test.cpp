#include "solver/methods/matrix_solver.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

struct Solved {
  EnergyField energy;
  Transport transport;
};

Solved solve_quietly(const PatchSet& scene, int rays, const std::string& form_factors = "rays", int seed = 1) {
  SolveConfig config;
  config.rays = rays;
  config.seed = seed;
  config.tolerance = 1e-6;
  config.form_factors = form_factors;
  Progress progress({"test", true, ""});
  Solved solved;
  solved.energy = solve_matrix(scene, config, rays, solved.transport, progress);
  return solved;
}

TEST(MatrixSolver, FurnacesReachTheirClosedForm) {
  for (const float rho : {0.0f, 0.5f, 0.9f, 0.99f, 0.9999f}) {
    PatchScene room, ball;
    room.room(1, 6, {rho, 1.0f});
    ball.sphere({1, 2, 3}, -1, 8, 12, {rho, 1.0f});
    for (const PatchSet* scene : {&room.get(), &ball.get()}) {
      const EnergyField energy = solve_quietly(*scene, 64).energy;
      for (const Color& b : radiosity(*scene, energy)) ASSERT_NEAR(b.y * (1 - rho), 1.0, 1e-3) << rho;
    }
  }
}

TEST(MatrixSolver, CubeWithOneHotFaceMatchesTheClosedForm) {
  PatchScene builder;
  builder.room(0.5, 1, {0.5f, 0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[0].light_group = 0;
  scene.patches[0].emission = Color(1.0f);
  for (const auto& [form_factors, rays] : {std::pair("rays", 1 << 18), std::pair("hemicube", 64)}) {
    const std::vector<Color> b = radiosity(scene, solve_quietly(scene, rays, form_factors).energy);
    const double tolerance = rays > 64 ? 2e-4 : 0.02;  // hemicubes are at the patch centres
    EXPECT_NEAR(b[0].y, 1.090909098, tolerance) << form_factors;
    EXPECT_NEAR(b[1].y, 0.181745826, tolerance) << form_factors;
    for (int side = 2; side < 6; ++side) EXPECT_NEAR(b[side].y, 0.181836269, tolerance) << form_factors;
  }
}

TEST(MatrixSolver, ADoubleSidedLampLightsARoomHoweverItIsTurned) {
  for (const double turn : {0.0, 0.349, 1.2}) {
    const Vec3d along(std::cos(turn), std::sin(turn), 0), across(0, 0.6, 0.8), middle(0.1, 0.7, -0.2);
    const auto corner = [&](double x, double y) { return middle + along * (0.8 * x) + across * (0.8 * y); };
    PatchScene builder;
    builder.room(2, 6, {0.0f});
    const int front = builder.quad({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)}, 3, 3, {0.0f, 1.0f});
    const int back = builder.quad({corner(1, -1), corner(-1, -1), corner(-1, 1), corner(1, 1)}, 3, 3, {0.0f, 1.0f});
    PatchSet& scene = builder.get();
    scene.primitives[front].back = back;
    scene.primitives[back].back = front;
    const EnergyField energy = solve_quietly(scene, 256).energy;
    double emitted = 0, absorbed = 0;
    for (std::size_t i = 0; i < scene.patches.size(); ++i) {
      const Patch& patch = scene.patches[i];
      const double irradiance = energy.groups[0].direct[i].y + energy.groups[0].indirect[i].y;
      emitted += patch.area * patch.emission.y;
      absorbed += patch.area * irradiance;
      EXPECT_TRUE(patch.primitive < front || irradiance == 0) << "the lamp is plane: " << turn;
    }
    EXPECT_NEAR(absorbed / emitted, 1, 5e-3) << turn;
  }
}

TEST(Solve, IntangibleLampsHideNothing) {
  for (const char* method : {"matrix", "progressive"})
    for (const char* form_factors : {"rays", "hemicube"}) {
      PatchScene builder;
      builder.room(1, 6, {0.5f, 1.0f});  // a furnace
      const int lamp =
          builder.quad({{{-0.5, 0.9, -0.5}, {0.5, 0.9, -0.5}, {0.5, 0.9, 0.5}, {-0.5, 0.9, 0.5}}}, 1, 1, {0.0f, 1e-6f});
      PatchSet& scene = builder.get();
      scene.primitives[lamp].intangible = true;
      SolveConfig config;
      config.method = method;
      config.form_factors = form_factors;
      config.tolerance = 1e-5;
      Transport transport;
      Progress progress({"test", true, ""});
      const EnergyField energy = solve(scene, config, transport, progress);
      const std::vector<Color> b = radiosity(scene, energy);
      const double noise = method == std::string("matrix") ? 0.02 : 0.3;  // a lamp that hides takes 0.8
      for (int i = 0; i < 6 * 36; ++i) EXPECT_NEAR(b[i].y, 2.0, noise) << method << ' ' << form_factors << ' ' << i;
      if (energy.estimate) {
        EXPECT_LT(energy.estimate->balance, 0.01);
      }
    }
}

TEST(MatrixSolver, DirectLightOfAPlaneMatchesTheClosedForm) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {0.5f, 3.0f});
  builder.quad({{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}}, 16, 16, {0.0f, 0.0f});
  const PatchSet& scene = builder.get();
  const EnergyField energy = solve_quietly(scene, 4).energy;
  double mean = 0;
  for (int i = 1; i <= 256; ++i) mean += energy.groups[0].direct[i].y / 256;
  EXPECT_NEAR(mean, 3 * 0.199824895698387, 1e-6) << "unoccluded, so without noise";
}

TEST(MatrixSolver, WallsThatTouchDoNotLeak) {
  PatchScene builder;
  builder.room(1, 8, {0.9f, 0.0f});
  const int wall = builder.quad({{{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}}}, 5, 5, {0.9f, 0.0f});
  const int back = builder.quad({{{0, -1, -1}, {0, -1, 1}, {0, 1, 1}, {0, 1, -1}}}, 5, 5, {0.9f, 0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[wall].back = back;
  scene.primitives[back].back = wall;
  scene.primitives[0].light_group = 0;
  for (int i = 0; i < 64; ++i) scene.patches[i].emission = Color(1.0f);
  const std::vector<Color> b = radiosity(scene, solve_quietly(scene, 256).energy);
  for (int i = 64; i < 128; ++i) EXPECT_EQ(b[i].y, 0) << "patch " << i << " of the wall at +x";
}

PatchScene shadowed_room() {
  PatchScene builder;
  builder.room(1, 8, {0.6f, 0.0f});
  builder.sphere({0.1, -0.2, 0.2}, 0.4, 6, 10, {0.5f, 0.0f});
  builder.quad({{{-0.3, 0.95, -0.3}, {0.3, 0.95, -0.3}, {0.3, 0.95, 0.3}, {-0.3, 0.95, 0.3}}}, 2, 2, {0.3f, 2.0f});
  return builder;
}

TEST(MatrixSolver, EstimatesItsError) {
  PatchScene builder = shadowed_room();
  const PatchSet& scene = builder.get();
  const EnergyField truth = solve_quietly(scene, 1 << 15).energy;
  double squares = 0, stated = 0;
  int within = 0;
  constexpr int kSeeds = 40;
  for (int seed = 2; seed < 2 + kSeeds; ++seed) {
    const EnergyField energy = solve_quietly(scene, 64, "rays", seed).energy;
    const double error = radiosity_error(scene, energy, truth);
    squares += error * error / kSeeds;
    stated += energy.estimate->error * energy.estimate->error / kSeeds;
    within += error <= energy.estimate->error_bound;
  }
  EXPECT_NEAR(std::sqrt(stated / squares), 1.0, 0.1);
  EXPECT_GE(within, 34);  // 38 expected; fewer than 34 has a probability of 1/300
}

TEST(Solve, CastsUntilTheErrorTargetIsMet) {
  PatchScene builder = shadowed_room();
  SolveConfig config;
  config.rays = 32;
  config.error_target = 0.01;
  Progress progress({"test", true, ""});
  Transport transport;
  const EnergyField energy = solve(builder.get(), config, transport, progress);
  EXPECT_LE(energy.estimate->error_bound, std::hypot(0.01, energy.estimate->error_patches));
  EXPECT_GT(energy.rays, 64 * transport.rows());
  EXPECT_EQ(solve(builder.get(), config, transport, progress).rays, 0) << "the transport is reused";
}

TEST(MatrixSolver, OtherColoursAndExitancesNeedNoRays) {
  PatchScene builder = shadowed_room();
  PatchSet& scene = builder.get();
  scene.geometry_key = "room";
  Solved first = solve_quietly(scene, 64);
  EXPECT_GT(first.energy.rays, 0);
  for (Patch& patch : scene.patches) patch.reflectance *= 0.5f;
  scene.patches.back().emission *= 3.0f;  // one patch of the lamp: its patches become separate emitters
  SolveConfig config;
  config.rays = 64;
  Progress progress({"test", true, ""});
  const EnergyField lamp = solve_matrix(scene, config, 64, first.transport, progress);
  EXPECT_GT(lamp.rays, 0);
  EXPECT_LT(lamp.rays, first.energy.rays);
  for (Patch& patch : scene.patches) patch.reflectance *= 0.5f;
  EXPECT_EQ(solve_matrix(scene, config, 64, first.transport, progress).rays, 0);
}

TEST(MatrixSolver, GivesTheSameBitsForAnyNumberOfThreads) {
  PatchScene builder = shadowed_room();
  std::vector<Solved> all;
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    all.push_back(solve_quietly(builder.get(), 100));
  }
  for (const Solved& solved : all) {
    EXPECT_EQ(solved.transport.columns, all[0].transport.columns);
    EXPECT_EQ(solved.energy.groups[0].direct, all[0].energy.groups[0].direct);
    EXPECT_EQ(solved.energy.groups[0].indirect, all[0].energy.groups[0].indirect);
    EXPECT_EQ(solved.energy.estimate->error, all[0].energy.estimate->error);
    EXPECT_EQ(solved.energy.estimate->error_bound, all[0].energy.estimate->error_bound);
    EXPECT_EQ(solved.energy.estimate->error_local, all[0].energy.estimate->error_local);
  }
}

TEST(MatrixSolver, ConservesEmittedPower) {
  PatchScene builder = shadowed_room();
  const EnergyField rough = solve_quietly(builder.get(), 16).energy, fine = solve_quietly(builder.get(), 4096).energy;
  EXPECT_GT(rough.estimate->reciprocity, 4 * fine.estimate->reciprocity);
  EXPECT_LT(fine.estimate->reciprocity, 0.02);
  EXPECT_LT(rough.estimate->balance, 0.01);
  EXPECT_LT(fine.estimate->balance, 1e-3);
}

}  // namespace
}  // namespace patchlight
