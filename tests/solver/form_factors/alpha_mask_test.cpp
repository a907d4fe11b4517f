// Transmission, reflection and emission of alpha-masked surfaces against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "solver/solve.h"
#include "tests/alpha_mask_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

struct Method {
  const char *method, *form_factors;
  double tolerance;
};
const std::array kMethods{Method{"matrix", "rays", 0.01}, Method{"progressive", "rays", 0.02},
                          Method{"matrix", "hemicube", 0.03}, Method{"progressive", "hemicube", 0.03}};

EnergyField solve_by(const PatchSet& scene, const Method& by, double tolerance = 1e-4, int rays = 256) {
  SolveConfig config;
  config.rays = rays;
  config.method = by.method;
  config.form_factors = by.form_factors;
  config.tolerance = tolerance;
  config.display = false;
  Progress progress({"test", true, ""});
  return solve(scene, config, progress);
}

double received(const PatchSet& scene, const EnergyField& energy, int primitive) {
  double sum = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    if (patch.primitive != primitive) continue;
    for (const auto& group : energy.groups)
      sum += patch.covered_area() * double(group.direct[i].y + group.indirect[i].y);
  }
  return sum;
}

/// A floor and a lamp above it, unit squares at distance 1, and between them a black two-sided screen with a
/// checkerboard of `count` x `count` squares, half of which are holes.
PatchSet screened(int count) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 8, 8, {0.0f});
  builder.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 8, 8, {0.0f, 1.0f});
  builder.quad({{{0, 0.5, 0}, {0, 0.5, 1}, {1, 0.5, 1}, {1, 0.5, 0}}}, 4, 4, {0.0f});
  builder.quad({{{1, 0.5, 0}, {1, 0.5, 1}, {0, 0.5, 1}, {0, 0.5, 0}}}, 4, 4, {0.0f});
  PatchSet scene = builder.get();
  for (const int side : {2, 3}) test::alpha_masked(scene, side, test::checkers(count), 0.5f);
  test::make_sides(scene, 2, 3);
  scene.texcoords.assign(4, kIdentityTexcoords);
  scene.texcoords[3] = {Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0), Vec2f(0, 0)};
  return scene;
}

TEST(AlphaMasks, HalfAScreenOfHolesLetsHalfTheLightThrough) {
  constexpr double kUnscreened = 0.199824895698387;
  const PatchSet scene = screened(64);
  for (const Method& by : kMethods)
    EXPECT_NEAR(received(scene, solve_by(scene, by), 0), kUnscreened / 2, by.tolerance * kUnscreened)
        << by.method << " " << by.form_factors;
}

TEST(AlphaMasks, LightPassesOnlyThroughHoles) {
  // A screen just above the floor with 2 x 2 squares, half of which are holes.
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 2, 2, {0.0f});
  builder.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 1, 1, {0.0f, 1.0f});
  builder.quad({{{0, 1e-3, 0}, {0, 1e-3, 1}, {1, 1e-3, 1}, {1, 1e-3, 0}}}, 1, 1, {0.0f});
  PatchSet scene = builder.get(), unscreened = scene;
  test::alpha_masked(scene, 2, test::checkers(2), 0.5f);
  std::erase_if(unscreened.patches, [](const Patch& patch) { return patch.primitive == 2; });
  unscreened.primitives.pop_back();
  for (const Method& by : {kMethods[0], kMethods[1]}) {
    const EnergyField energy = solve_by(scene, by), reference = solve_by(unscreened, by);
    for (std::size_t i = 0; i < 4; ++i) {
      const bool hole = i == 1 || i == 2;
      const double whole = reference.groups[0].direct[i].y;
      EXPECT_NEAR(energy.groups[0].direct[i].y, hole ? whole : 0.0, 5 * by.tolerance * whole) << by.method << " " << i;
    }
  }
}

/// The inside of a sphere with a perforated baffle, everywhere with the same exitance and reflectance.
PatchSet furnace(float reflectance) {
  PatchScene builder;
  builder.sphere({0, 0, 0}, -1.5, 8, 12, {reflectance, 1.0f});
  builder.quad({{{0, -0.9, -0.9}, {0, 0.9, -0.9}, {0, 0.9, 0.9}, {0, -0.9, 0.9}}}, 4, 4, {reflectance, 1.0f});
  builder.quad({{{0, 0.9, -0.9}, {0, -0.9, -0.9}, {0, -0.9, 0.9}, {0, 0.9, 0.9}}}, 4, 4, {reflectance, 1.0f});
  PatchSet scene = builder.get();
  for (const int side : {1, 2}) test::alpha_masked(scene, side, test::checkers(16), 0.5f);
  test::make_sides(scene, 1, 2);
  scene.texcoords.assign(3, kIdentityTexcoords);
  scene.texcoords[2] = {Vec2f(1, 0), Vec2f(0, 0), Vec2f(0, 1), Vec2f(1, 1)};
  return scene;
}

TEST(AlphaMasks, AFurnaceWithAPerforatedBaffleIsUniform) {
  for (const float reflectance : {0.5f, 0.9f}) {
    const PatchSet scene = furnace(reflectance);
    const EnergyField energy = solve_by(scene, kMethods[0], 1e-6);
    const double irradiance = 1 / (1.0 - double(reflectance));
    for (std::size_t i = 0; i < scene.patches.size(); ++i)
      EXPECT_NEAR(energy.groups[0].direct[i].y + energy.groups[0].indirect[i].y, irradiance, 1e-4 * irradiance) << i;
  }
  const PatchSet scene = furnace(0.5f);
  for (const Method& by : {kMethods[1], kMethods[2]}) {
    const EnergyField energy = solve_by(scene, by);
    double sum = 0, area = 0;
    for (int primitive = 0; primitive < 3; ++primitive) sum += received(scene, energy, primitive);
    for (const Patch& patch : scene.patches) area += patch.covered_area();
    EXPECT_NEAR(sum / area, 2, by.tolerance * 2) << by.method << " " << by.form_factors;
  }
}

TEST(AlphaMasks, APerforatedLampEmitsInProportionToItsCoverage) {
  PatchScene builder;
  builder.room(1, 4, {0.0f});
  builder.quad({{{-0.5, 0, -0.5}, {0.5, 0, -0.5}, {0.5, 0, 0.5}, {-0.5, 0, 0.5}}}, 2, 2, {0.0f, 3.0f});
  PatchSet scene = builder.get();
  test::alpha_masked(scene, 6, {4, 1, {}, true, {255, 0, 0, 0}}, 1.0f);
  for (Patch& patch : scene.patches)
    if (patch.primitive == 6) patch.coverage = patch.u0 == 0 ? 0.5f : 1.0f / 1024;
  for (const Method& by : kMethods) {
    const EnergyField energy = solve_by(scene, by, 1e-4, 8192);
    double sum = 0;
    for (int wall = 0; wall < 6; ++wall) sum += received(scene, energy, wall);
    EXPECT_NEAR(sum, 0.75, 0.03 * 0.75) << by.method << " " << by.form_factors;
  }
}

TEST(AlphaMasks, ReflectionIsProportionalToCoverage) {
  // A white square with half of its area masked reflects half as much light to a black ceiling.
  const auto reflected = [](bool masked, const Method& by) {
    PatchScene builder;
    builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 4, 4, {0.8f});
    builder.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 4, 4, {0.0f, 1.0f});
    PatchSet scene = builder.get();
    if (masked) test::alpha_masked(scene, 0, test::checkers(32), 0.5f);
    return received(scene, solve_by(scene, by), 1);
  };
  for (const Method& by : kMethods)
    EXPECT_NEAR(reflected(true, by) / reflected(false, by), 0.5, std::max(0.02, by.tolerance))
        << by.method << " " << by.form_factors;
}

}  // namespace
}  // namespace patchlight
