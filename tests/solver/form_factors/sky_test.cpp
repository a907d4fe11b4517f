#include "pipeline/optics/lights/sky.h"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

const Color kRadiance(2.0f, 1.0f, 0.0f);

/// A uniform environment with one cell or many.
Environment uniform_sky(int rows) {
  Environment sky;
  sky.texels.assign(1, kRadiance);
  sky.rows = rows;
  sky.cells.assign(std::size_t(rows == 1 ? 1 : 2 * rows * rows), kRadiance);
  return sky;
}

EnergyField solve_quietly(const PatchSet& scene, const SolveConfig& config, Transport& transport) {
  Progress progress({"test", true, ""});
  return solve(scene, config, transport, progress);
}

EnergyField solve_quietly(const PatchSet& scene, const std::string& method = "matrix",
                          const std::string& form_factors = "rays") {
  SolveConfig config;
  config.method = method;
  config.form_factors = form_factors;
  config.hemicube_resolution = 32;
  Transport transport;
  return solve_quietly(scene, config, transport);
}

TEST(SkySolved, AFloorReceivesPiTimesItsRadiance) {
  PatchScene builder;
  builder.quad({{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}}, 4, 4, {0.5f});
  for (const int rows : {1, 24})
    for (const char* method : {"matrix", "progressive"})
      for (const char* form_factors : {"rays", "hemicube"}) {
        PatchSet scene = builder.get();
        scene.environment = uniform_sky(rows);
        const EnergyField energy = solve_quietly(scene, method, form_factors);
        for (std::size_t i = 0; i < scene.patches.size(); ++i) {
          EXPECT_NEAR(energy.groups[0].direct[i].x, 2 * kPi, 1e-4) << method << form_factors;
          EXPECT_NEAR(energy.groups[0].direct[i].y, kPi, 1e-4);
          EXPECT_EQ(energy.groups[0].direct[i].z, 0);
        }
      }
}

TEST(SkySolved, NothingGetsMoreThanItBehindASingleSidedPanel) {
  for (const double gap : {0.02, 0.2, 1.0}) {
    PatchScene builder;  // a wall on a floor, and a panel before the wall with its unlit back to it
    builder.quad({{{-2, 0, 0}, {2, 0, 0}, {2, 3, 0}, {-2, 3, 0}}}, 8, 6, {0.0f});
    builder.quad({{{-2, 0, 0}, {-2, 0, 3}, {2, 0, 3}, {2, 0, 0}}}, 8, 6, {0.0f});
    builder.quad({{{-1, 0.3, gap}, {1, 0.3, gap}, {1, 2, gap}, {-1, 2, gap}}}, 4, 4, {0.0f});
    PatchSet& scene = builder.get();
    scene.environment = uniform_sky(24);
    for (const char* method : {"matrix", "progressive"})
      for (const char* form_factors : {"rays", "hemicube"}) {
        const EnergyField energy = solve_quietly(scene, method, form_factors);
        for (const Color& irradiance : energy.groups[0].direct)
          EXPECT_LE(irradiance.y, 1.001 * kPi) << method << form_factors << gap;
      }
  }
}

TEST(SkySolved, AWallHidesHalfOfIt) {
  PatchScene builder;
  builder.quad({{{0, 0, -0.1}, {0, 0, 0.1}, {0.01, 0, 0.1}, {0.01, 0, -0.1}}}, 1, 4, {0.0f});
  builder.quad({{{-0.001, 0, 500}, {-0.001, 0, -500}, {-0.001, 500, -500}, {-0.001, 500, 500}}}, 1, 1, {0.0f});
  PatchSet& scene = builder.get();
  scene.environment = uniform_sky(24);
  const EnergyField energy = solve_quietly(scene);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(energy.groups[0].direct[i].x / (2 * kPi), 0.5, 0.01);
}

TEST(SkySolved, AFurnaceIsAsBrightAsItsSky) {
  // Surfaces under a uniform sky that absorb nothing have B = pi L.
  PatchScene builder;
  constexpr float kWhite = 0.9999f;
  builder.sphere({0, 2, 0}, 1, 12, 16, {kWhite});
  builder.quad({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}}, 8, 8, {kWhite});
  builder.quad({{{-2, 0, 2}, {-2, 0, -2}, {2, 0, -2}, {2, 0, 2}}}, 8, 8, {kWhite});  // the back side
  PatchSet& scene = builder.get();
  scene.primitives[1].back = 2;
  scene.primitives[2].back = 1;
  scene.environment = uniform_sky(24);
  for (const char* method : {"matrix", "progressive"}) {
    const EnergyField energy = solve_quietly(scene, method);
    const bool exact = energy.method == "matrix";  // shot light is scattered randomly
    const std::vector<Color> b = radiosity(scene, energy);
    double square = 0, area = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
      EXPECT_NEAR(b[i].x / (2 * kPi), 1.0, exact ? 0.01 : 1.0);
      square += scene.patches[i].area * std::pow(b[i].x / (2 * kPi) - 1, 2);
      area += scene.patches[i].area;
    }
    EXPECT_LT(std::sqrt(square / area), 0.06) << method;
    EXPECT_LT(energy.estimate.value_or(EnergyField::Estimate{}).balance, 0.01);
    ASSERT_TRUE(energy.display);
    for (const Color& h : energy.groups[0].display) EXPECT_NEAR(h.x / (2 * kPi), 1.0, exact ? 0.01 : 0.1);
  }
}

TEST(SkySolved, CellsLightFromTheirDirection) {
  // With one bright cell, the floor's irradiance is L times cosine times the cell's solid angle.
  PatchScene builder;
  builder.quad({{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}}, 1, 1, {0.0f});
  PatchSet& scene = builder.get();
  scene.environment = uniform_sky(4);
  Environment& sky = *scene.environment;
  for (const Vec3f& direction : {Vec3f(0.5f, 0.4f, 0.1f), Vec3f(-0.2f, 0.9f, -0.3f), Vec3f(0.5f, -0.4f, 0.1f)}) {
    std::fill(sky.cells.begin(), sky.cells.end(), Color(0.0f));
    const std::int32_t cell = sky_cell(sky, direction);
    sky.cells[cell] = Color(1.0f);
    const double height = std::max(0.0, 0.75 - 0.5 * (cell / 8));  // mean cosine of the cell, whose y runs evenly
    const double expected = height * 4 * kPi / 32;
    SolveConfig config;
    config.rays = 4096;
    Transport transport;
    EXPECT_NEAR(solve_quietly(scene, config, transport).groups[0].direct[0].x, expected, 0.02 * expected + 1e-3);
  }
}

TEST(SkySolved, MirrorsReflectIt) {
  // A mirror that covers half of the sky reflects the other half.
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{0, 0, -0.1}, {0, 0, 0.1}, {0.01, 0, 0.1}, {0.01, 0, -0.1}}}, 1, 4, {0.5f});
  builder.quad({{{-0.001, 0, 500}, {-0.001, 0, -500}, {-0.001, 500, -500}, {-0.001, 500, 500}}}, 1, 1,
               {0.0f, 0.0f, 0, 1});
  PatchSet& scene = builder.get();
  scene.environment = uniform_sky(24);
  const EnergyField energy = solve_quietly(scene);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(energy.groups[0].direct[i].x / (2 * kPi), 0.5, 0.01);
    EXPECT_NEAR(energy.groups[0].indirect[i].x / (2 * kPi), 0.25, 0.01);
  }
}

TEST(SkySolved, AnotherSkyNeedsNoRays) {
  PatchScene builder;
  builder.room(1, 4, {0.5f});
  PatchSet& scene = builder.get();
  scene.primitives.pop_back();  // open on one side
  scene.patches.resize(scene.patches.size() - 16);
  scene.geometry_key = "geometry";
  scene.environment = uniform_sky(24);
  Transport transport;
  const EnergyField first = solve_quietly(scene, {}, transport);
  EXPECT_GT(first.rays, 0);
  for (Color& cell : scene.environment->cells) cell *= 2.0f;
  const EnergyField second = solve_quietly(scene, {}, transport);
  EXPECT_EQ(second.rays, 0);
  for (std::size_t i = 0; i < scene.patches.size(); ++i)
    EXPECT_NEAR(second.groups[0].direct[i].x, 2 * first.groups[0].direct[i].x, 1e-3);
}

}  // namespace
}  // namespace patchlight
