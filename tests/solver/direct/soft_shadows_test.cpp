#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/lights/direct_light.h"
#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::light_at;
using test::PatchScene;

constexpr double kEdgeHeight = 1.0, kHalfFloor = 1.0;
constexpr int kCells = 64;

/// A floor under a half-plane that hides everything at x < 0, as far as the light reaches.
PatchScene floor_below_an_edge() {
  PatchScene builder;
  const double f = kHalfFloor, h = kEdgeHeight, far = 50;
  builder.quad({{{-f, 0, -0.05}, {-f, 0, 0.05}, {f, 0, 0.05}, {f, 0, -0.05}}}, 1, kCells, {0.0f});
  builder.quad({{{-far, h, -far}, {0, h, -far}, {0, h, far}, {-far, h, far}}}, 1, 1, {0.0f});
  return builder;
}

/// Part of a disk's area beyond a chord at a distance from its centre, in radii.
double beyond_chord(double distance) {
  const double c = std::clamp(distance, -1.0, 1.0);
  return (std::acos(c) - c * std::sqrt(1 - c * c)) / kPi;
}

struct Penumbra {
  double rms = 0, largest = 0;  ///< Errors of the visible fraction.
  int partial = 0;              ///< Patches in the penumbra.
};

/// Compares each patch with the mean of `visible(x)`, the visible fraction at a place.
template <class Visible>
Penumbra penumbra_of(const Light& light, Visible visible) {
  PatchScene builder = floor_below_an_edge();
  PatchSet& scene = builder.get();
  scene.lights = {light};
  SolveConfig config;
  config.display = false;
  Progress progress({"test", true, ""});
  const EnergyField energy = solve(scene, config, progress);
  const DirectLight whole(light);
  Penumbra result;
  for (int i = 0; i < kCells; ++i) {
    const Vec3d center = scene.patches[i].center;
    constexpr int kPoints = 16;
    double expected = 0;
    for (int k = 0; k < kPoints; ++k)
      expected += visible(center.x + ((k + 0.5) / kPoints - 0.5) * 2 * kHalfFloor / kCells) / kPoints;
    const double unoccluded = 10 * whole.form_factor(center, {0, 1, 0});
    const double error = energy.groups[0].direct[i].x / unoccluded - expected;
    result.rms += error * error / kCells;
    result.largest = std::max(result.largest, std::abs(error));
    result.partial += expected > 0.02 && expected < 0.98;
  }
  result.rms = std::sqrt(result.rms);
  return result;
}

/// Three standard deviations of the visible fraction by as many independent samples as a patch in a penumbra takes:
/// 256 in each of two sample sets.
const double kTolerance = 3 * 0.5 / std::sqrt(2 * 256.0);

/// Expects the part of a light that is visible; `sharp`: the light without extent, whose shadow must be told apart.
template <class Visible>
void expect_penumbra(const Light& light, const Light& sharp, const Visible& visible) {
  const Penumbra penumbra = penumbra_of(light, visible);
  EXPECT_GE(penumbra.partial, 8);
  EXPECT_LT(penumbra.largest, kTolerance);
  EXPECT_LT(penumbra.rms, kTolerance / 6);
  EXPECT_GT(penumbra_of(sharp, visible).largest, 2 * kTolerance);
}

TEST(SoftShadows, OfASunBehindAnEdgeShowTheVisiblePartOfItsDisk) {
  Light sun = light_at({0, 0, 0}, Light::Kind::sun);
  sun.outer = 0.15;
  // The edge cuts the disk, as projected onto the floor, at the sine of its angle.
  const auto visible = [sine = std::sin(sun.outer)](double x) {
    const double tangent = -x / kEdgeHeight;
    return beyond_chord(tangent / std::sqrt(1 + tangent * tangent) / sine);
  };
  Light sharp = sun;
  sharp.outer = 0;
  expect_penumbra(sun, sharp, visible);
}

TEST(SoftShadows, OfALightWithARadiusBehindAnEdgeShowTheVisiblePartOfItsBall) {
  const double height = 3;
  Light ball = light_at({0, height, 0});
  ball.radius = 0.3;
  // Seen from the floor nearly below it, the ball is a disk of angular radius asin(r / d).
  const auto visible = [height, radius = ball.radius](double x) {
    const double distance = std::hypot(x, height);
    const double edge = std::atan2(-x, kEdgeHeight), center = std::atan2(-x, height);
    return beyond_chord(std::sin(edge - center) / (radius / distance));
  };
  Light sharp = ball;
  sharp.radius = 0;
  expect_penumbra(ball, sharp, visible);
}

TEST(SoftShadows, OfALightWithARadiusCloseAboveAPlaneGiveWayToThePointsIrradiance) {
  PatchScene builder;
  builder.quad({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}}, 32, 32, {0.0f});
  PatchSet& scene = builder.get();
  scene.lights = {light_at({0.1, 0.3, 0.05})};
  scene.lights[0].radius = 0.1;
  SolveConfig config;
  Progress progress({"test", true, ""});
  const EnergyField energy = solve(scene, config, progress);
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Vec3d to = scene.lights[0].position - scene.patches[i].center;
    const double expected = 10 * to.y / std::pow(to.length(), 3);
    if (to.length() < 0.6) continue;
    ASSERT_NEAR(energy.groups[0].direct[i].x, expected, 0.01 * expected) << i;
  }
}

TEST(SoftShadows, OfAnotherRadiusCastTheRaysOfTheirLightOnly) {
  PatchScene builder;
  builder.room(1, 6, {0.5f});
  builder.quad({{{-0.3, 0, -0.3}, {0.3, 0, -0.3}, {0.3, 0, 0.3}, {-0.3, 0, 0.3}}}, 2, 2, {0.5f});
  PatchSet& scene = builder.get();
  scene.light_groups = {"a", "b"};
  scene.lights = {light_at({0.2, 0.6, -0.4}), light_at({0, 0, 0}, Light::Kind::sun)};
  scene.lights[1].light_group = 1;
  scene.geometry_key = "geometry";
  const auto solved = [&](Transport& transport) {
    Progress progress({"test", true, ""});
    return solve(scene, {}, transport, progress);
  };
  Transport transport, none, also_none;
  const EnergyField first = solved(transport);
  scene.lights[0].radius = 0.2;
  const EnergyField soft = solved(transport), fresh = solved(none);
  EXPECT_GT(soft.rays, 0);
  EXPECT_LT(soft.rays, first.rays / 4) << "rows are not cast again";
  EXPECT_NE(soft.groups[0].direct, first.groups[0].direct);
  EXPECT_EQ(soft.groups[1].direct, first.groups[1].direct) << "nor is the other light";
  EXPECT_EQ(soft.groups[0].direct, fresh.groups[0].direct);
  EXPECT_EQ(soft.groups[0].display, fresh.groups[0].display);
  EXPECT_EQ(solved(transport).rays, 0);
  scene.lights[1].outer = 0.1;
  const EnergyField softer = solved(transport);
  EXPECT_GT(softer.rays, 0);
  EXPECT_LT(softer.rays, first.rays / 4);
  EXPECT_EQ(softer.groups[0].direct, soft.groups[0].direct);
  EXPECT_EQ(softer.groups[1].direct, solved(also_none).groups[1].direct);
}

}  // namespace
}  // namespace patchlight
