#include <gtest/gtest.h>

#include <cmath>

#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::light_at;
using test::PatchScene;

/// A floor of 4 x 4 m about the origin.
void add_floor(PatchScene& builder, float reflectance, int cells = 32) {
  builder.quad({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}}, cells, cells, {reflectance});
}

SolveConfig config_of(const std::string& method, const std::string& form_factors) {
  SolveConfig config;
  config.method = method;
  config.form_factors = form_factors;
  config.hemicube_resolution = 32;
  return config;
}

EnergyField solve_quietly(const PatchSet& scene, const SolveConfig& config, Transport& transport) {
  Progress progress({"test", true, ""});
  return solve(scene, config, transport, progress);
}

EnergyField solve_quietly(const PatchSet& scene, const SolveConfig& config = {}) {
  Transport transport;
  return solve_quietly(scene, config, transport);
}

TEST(LightsSolved, EveryConfigurationMatchesTheClosedFormOnAFloor) {
  PatchScene builder;
  add_floor(builder, 0.5f);
  for (const auto kind : {Light::Kind::point, Light::Kind::sun}) {
    PatchSet scene = builder.get();
    scene.lights = {light_at({0.3, 1.5, 0.2}, kind)};
    for (const char* method : {"matrix", "progressive"})
      for (const char* form_factors : {"rays", "hemicube"}) {
        const EnergyField energy = solve_quietly(scene, config_of(method, form_factors));
        for (std::size_t i = 0; i < scene.patches.size(); ++i) {
          const Vec3d to = Vec3d(0.3, 1.5, 0.2) - scene.patches[i].center;
          const double factor = kind == Light::Kind::sun ? 1.0 : to.y / std::pow(to.length(), 3);
          ASSERT_NEAR(energy.groups[0].direct[i].x, 10 * factor, 0.004 * 10 * factor) << method << form_factors << i;
          ASSERT_NEAR(energy.groups[0].direct[i].y, 5 * factor, 0.004 * 5 * factor);
          ASSERT_EQ(energy.groups[0].direct[i].z, 0);
          ASSERT_EQ(energy.groups[0].indirect[i].x, 0) << "a floor receives no light from itself";
        }
      }
  }
}

TEST(LightsSolved, EveryConfigurationConservesReflectedPower) {
  // A closed room of reflectance rho absorbs all light of a lamp in it: area (1 - rho) H = 4 pi I.
  PatchScene builder;
  builder.room(1, 8, {0.6f});
  PatchSet& scene = builder.get();
  scene.lights = {light_at({0.2, 0.3, -0.4})};
  for (const char* method : {"matrix", "progressive"})
    for (const char* form_factors : {"rays", "hemicube"}) {
      const EnergyField energy = solve_quietly(scene, config_of(method, form_factors));
      double absorbed = 0;
      const std::vector<Color> b = radiosity(scene, energy);
      for (std::size_t i = 0; i < b.size(); ++i) absorbed += scene.patches[i].area * b[i].x / 0.6 * 0.4;
      EXPECT_NEAR(absorbed / (4 * kPi * 10), 1.0, 0.02) << method << " " << form_factors;
      if (!energy.estimate) continue;
      EXPECT_LT(energy.estimate->balance, 0.03);
      EXPECT_LT(energy.estimate->error, 0.05);
      EXPECT_GT(energy.estimate->error, 0);
    }
}

TEST(LightsSolved, ShadowsAreSharpAndBlack) {
  PatchScene builder;
  add_floor(builder, 0.5f);
  builder.quad({{{-0.5, 1, -0.5}, {-0.5, 1, 0.5}, {0.5, 1, 0.5}, {0.5, 1, -0.5}}}, 1, 1, {0.0f});
  builder.quad({{{-0.5, 1, 0.5}, {-0.5, 1, -0.5}, {0.5, 1, -0.5}, {0.5, 1, 0.5}}}, 1, 1, {0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[1].back = 2;
  scene.primitives[2].back = 1;
  scene.lights = {light_at({0, 2, 0})};
  const EnergyField energy = solve_quietly(scene);
  for (std::size_t i = 0; i < 32 * 32; ++i) {
    const Patch& patch = scene.patches[i];
    const double across = std::max(std::abs(patch.center.x), std::abs(patch.center.z)), size = 4.0 / 32;
    const double whole = 10 * 2 / std::pow((Vec3d(0, 2, 0) - patch.center).length(), 3);
    const double light = energy.groups[0].direct[i].x;
    if (across < 1 - size) {  // the shadow is twice as wide as the occluder
      EXPECT_EQ(light, 0) << i;
    } else if (across > 1 + size) {
      EXPECT_NEAR(light, whole, 0.01 * whole) << i;
    } else {
      EXPECT_LT(light, 1.02 * whole);
    }
  }
}

TEST(LightsSolved, OtherStrengthsNeedNoRaysAndOtherPositionsOnlyTheirOwn) {
  PatchScene builder;
  builder.room(1, 6, {0.5f});
  PatchSet& scene = builder.get();
  scene.light_groups = {"a", "b"};
  scene.lights = {light_at({0.2, 0.3, -0.4}), light_at({-0.5, 0.5, 0.5})};
  scene.lights[1].light_group = 1;
  scene.geometry_key = "geometry";
  Transport transport;
  const EnergyField first = solve_quietly(scene, {}, transport);
  EXPECT_GT(first.rays, 0);

  scene.lights[0].strength *= 2.0f;
  const EnergyField brighter = solve_quietly(scene, {}, transport);
  EXPECT_EQ(brighter.rays, 0);
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    EXPECT_NEAR(brighter.groups[0].direct[i].x, 2 * first.groups[0].direct[i].x, 1e-5f * first.groups[0].direct[i].x);
    EXPECT_EQ(brighter.groups[1].direct[i].x, first.groups[1].direct[i].x);
  }

  std::swap(scene.lights[0], scene.lights[1]);
  const EnergyField swapped = solve_quietly(scene, {}, transport);
  EXPECT_EQ(swapped.rays, 0);
  for (std::size_t i = 0; i < scene.patches.size(); ++i)
    EXPECT_EQ(swapped.groups[0].direct[i], brighter.groups[0].direct[i]) << "factors follow their light";

  scene.lights[0].position.y = -0.5;
  const EnergyField moved = solve_quietly(scene, {}, transport);
  EXPECT_GT(moved.rays, 0);
  EXPECT_LT(moved.rays, first.rays / 2) << "the rows are reused";
  Transport none;
  const EnergyField fresh = solve_quietly(scene, {}, none);
  for (std::size_t g = 0; g < 2; ++g) {
    EXPECT_EQ(moved.groups[g].direct, fresh.groups[g].direct);
    EXPECT_EQ(moved.groups[g].indirect, fresh.groups[g].indirect);
    EXPECT_EQ(moved.groups[g].display, fresh.groups[g].display);
  }
}

TEST(LightsSolved, MirrorsReflectTheirLight) {
  // The mirror image of the light is behind the plane x = 1 and lights through the mirror's 1 x 1 m.
  for (const auto kind : {Light::Kind::point, Light::Kind::sun}) {
    PatchScene builder;
    builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
    constexpr int kCells = 36;
    builder.quad({{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}}, kCells, kCells, {0.0f});
    builder.quad({{{1, 0.5, -0.5}, {1, 0.5, 0.5}, {1, 1.5, 0.5}, {1, 1.5, -0.5}}}, 1, 1, {0.0f, 0.0f, 0, 1});
    PatchSet& scene = builder.get();
    ASSERT_LT(scene.patches.back().normal.x, -0.9f);
    scene.lights = {light_at({0.3, 1, 0}, kind)};
    scene.lights[0].direction = {0.8, -0.6, 0};
    SolveConfig config;
    config.rays = 1024;
    config.display = false;
    const EnergyField energy = solve_quietly(scene, config);
    double received = 0, expected = 0;
    for (std::size_t i = 0; i + 1 < scene.patches.size(); ++i)
      received += scene.patches[i].area * energy.groups[0].indirect[i].x;
    if (kind == Light::Kind::sun) {
      expected = 0.5 * 10 * 0.8;
    } else {
      constexpr int kFine = 720;
      for (int j = 0; j < kFine; ++j)
        for (int k = 0; k < kFine; ++k) {
          const Vec3d place(-9 + (j + 0.5) * 18 / kFine, 0, -9 + (k + 0.5) * 18 / kFine);
          const Vec3d to = Vec3d(1.7, 1, 0) - place, through = place + to * ((1 - place.x) / to.x);
          if (place.x < 1 && through.y > 0.5 && through.y < 1.5 && std::abs(through.z) < 0.5)
            expected += 0.5 * 10 * to.y / std::pow(to.length(), 3) * std::pow(18.0 / kFine, 2);
        }
    }
    EXPECT_NEAR(received, expected, 0.03 * expected) << int(kind);
  }
}

}  // namespace
}  // namespace patchlight
