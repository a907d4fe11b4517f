#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/surface/coat_albedo.h"
#include "solver/solve.h"
#include "tests/glass_scene.h"

namespace patchlight {
namespace {

using test::add_glass;
using test::add_level;
using test::add_veil;
using test::fresnel;
using test::PatchScene;

EnergyField solve_quietly(const PatchSet& scene, int rays = 1024) {
  SolveConfig config;
  config.rays = rays;
  config.display = false;
  Transport transport;
  Progress progress({"test", true, ""});
  return solve(scene, config, transport, progress);
}

Color irradiance(const EnergyField& energy, std::size_t patch) {
  Color sum(0.0f);
  for (const auto& group : energy.groups) sum += group.direct[patch] + group.indirect[patch];
  return sum;
}

/// Mean of 1 - fresnel() over the hemisphere, by the cosine: `passed(r)` of one surface or of both faces of a plate.
template <class Passed>
double hemispherical(Passed passed) {
  double sum = 0;
  constexpr int kSteps = 20000;
  for (int k = 0; k < kSteps; ++k) sum += passed(fresnel(1.5, std::sqrt((k + 0.5) / kSteps))) / kSteps;
  return sum;
}

/// A wide black floor under glass, in a white sky.
PatchSet floor_under_glass(bool solid, const Color& tint = Color(1.0f)) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), solid, 0.0f, 1.5f, tint);
  add_level(builder, 0, 1, true, {0.0f}, 2);
  add_level(builder, -0.01, 400, true, {0.0f});
  add_level(builder, 0.2, 400, true, {0.0f, 0.0f, 0, glass});
  if (solid) add_level(builder, 0.1, 400, false, {0.0f, 0.0f, 0, glass});
  builder.get().environment = test::white_sky();
  return builder.get();
}

TEST(GlassSolved, LetsTheSkyThroughAsFresnelHasIt) {
  const double sheet = hemispherical([](double r) { return 1 - r; });
  const double plate = hemispherical([](double r) { return (1 - r) / (1 + r); });
  for (const bool solid : {false, true}) {
    const EnergyField energy = solve_quietly(floor_under_glass(solid), 1 << 14);
    double mean = 0;
    for (std::size_t i = 0; i < 4; ++i) mean += double(irradiance(energy, i).y) / 4 / kPi;
    EXPECT_NEAR(mean, solid ? plate : sheet, 0.005) << solid;
  }
  const EnergyField green = solve_quietly(floor_under_glass(false, {0.25f, 1.0f, 0.0f}));
  EXPECT_NEAR(irradiance(green, 0).y / float(kPi), sheet, 0.02);
  EXPECT_NEAR(irradiance(green, 0).x / float(kPi), sheet / 4, 0.01);
  EXPECT_EQ(irradiance(green, 0).z, 0.0f);
}

TEST(GlassSolved, ThatAbsorbsNothingDoesNotDarkenAWhiteWorld) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), true), thin = add_glass(builder.get(), false);
  add_level(builder, 0, 2, true, {0.99999f}, 6);
  builder.sphere({0, 0.7, 0}, 0.6, 8, 16, {0.0f, 0.0f, 0, glass});
  builder.quad({{{1, 0, 1}, {1, 0, -1}, {1, 1, -1}, {1, 1, 1}}}, 2, 2, {0.0f, 0.0f, 0, thin});
  builder.get().environment = test::white_sky();
  const EnergyField energy = solve_quietly(builder.get());
  for (std::size_t i = 0; i < 36; ++i) EXPECT_NEAR(irradiance(energy, i).y, kPi, 0.03 * kPi) << i;
}

/// A floor under a small lamp, with a sheet of glass or a veil in between.
Color under_a_lamp(int kind) {
  PatchScene builder;
  PatchSet& scene = builder.get();
  const int red = add_glass(scene, false, 0.0f, 1.5f, {0.9f, 0.3f, 0.1f});
  const int veil = add_veil(scene, 0.4f);
  add_level(builder, 0, 0.1, true, {0.0f});
  add_level(builder, 2, 0.05, false, {0.0f, 100.0f});
  if (kind == 1) add_level(builder, 1, 3, true, {0.0f, 0.0f, 0, red});
  if (kind == 2) scene.primitives[add_level(builder, 1, 3, true, {0.0f, 0.0f, 0, veil})].mask = 0;
  for (std::size_t i = 2; i < scene.primitives.size(); ++i) scene.primitives[i].light_group = -1;
  scene.primitives[0].light_group = -1;
  return irradiance(solve_quietly(scene), 0);
}

TEST(GlassSolved, ColoursTheDirectLightOfLamps) {
  const Color open = under_a_lamp(0), glass = under_a_lamp(1), veil = under_a_lamp(2);
  EXPECT_NEAR(glass.x / open.x, 0.9 * 0.96, 0.005);
  EXPECT_NEAR(glass.y / open.y, 0.3 * 0.96, 0.005);
  EXPECT_NEAR(glass.z / open.z, 0.1 * 0.96, 0.005);
  EXPECT_NEAR(veil.y / open.y, 0.6, 0.005);
}

/// Light that a white veil reflects in a closed white room is kept, and so is what passes it.
TEST(GlassSolved, VeilsInAWhiteWorldAbsorbNothing) {
  PatchScene builder;
  PatchSet& scene = builder.get();
  const int veil = add_veil(scene, 0.5f);
  add_level(builder, 0, 2, true, {0.99999f}, 6);
  const int front = add_level(builder, 0.5, 1, true, {0.99999f, 0.0f, 0, veil}, 4);
  const int back = add_level(builder, 0.5, 1, false, {0.99999f, 0.0f, 0, veil}, 4);
  for (const int side : {front, back}) scene.primitives[side].mask = 0;
  scene.primitives[front].back = back;
  scene.primitives[back].back = front;
  for (Patch& patch : scene.patches)
    if (patch.primitive != 0) patch.coverage = 0.5f;
  scene.environment = test::white_sky();
  const EnergyField energy = solve_quietly(scene);
  for (std::size_t i = 0; i < 36; ++i) EXPECT_NEAR(irradiance(energy, i).y, kPi, 0.03 * kPi) << i;
}

/// The power that the black walls of a room absorb, over that of a lamp, with something of glass under it.
double absorbed_power(int kind) {
  PatchScene builder;
  PatchSet& scene = builder.get();
  const int ball = add_glass(scene, true), rough = add_glass(scene, false, 0.4f), plate = add_glass(scene, true);
  builder.room(1, 8, {0.0f});
  const std::size_t walls = scene.patches.size();
  add_level(builder, 0.9, 0.1, false, {0.0f, 1.0f});
  if (kind == 1) builder.sphere({0, 0.2, 0}, 0.4, 8, 16, {0.0f, 0.0f, 0, ball});
  if (kind == 2) add_level(builder, 0.2, 0.5, true, {0.0f, 0.0f, 0, rough});
  if (kind == 3) {
    add_level(builder, 0.25, 0.5, true, {0.0f, 0.0f, 0, plate});
    add_level(builder, 0.2, 0.5, false, {0.0f, 0.0f, 0, plate});
  }
  for (Primitive& primitive : scene.primitives) primitive.light_group = -1;
  scene.primitives[6].light_group = 0;
  const EnergyField energy = solve_quietly(scene);
  double sum = 0;
  for (std::size_t i = 0; i < walls; ++i) sum += scene.patches[i].area * double(irradiance(energy, i).y);
  return sum / (scene.patches[walls].area * double(scene.patches[walls].emission.y));
}

TEST(GlassSolved, KeepsThePowerOfALampThatItTurns) {
  EXPECT_NEAR(absorbed_power(0), 1, 0.005);
  EXPECT_NEAR(absorbed_power(1), 1, 0.01) << "a ball";
  EXPECT_NEAR(absorbed_power(2), 1, 0.01) << "a rough sheet";
  EXPECT_NEAR(absorbed_power(3), 1, 0.02) << "a plate, of which the offset and the open edges are left out";
}

}  // namespace
}  // namespace patchlight
