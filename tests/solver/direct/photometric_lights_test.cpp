#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/lights/direct_light.h"
#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::light_at;
using test::PatchScene;

/// Relative intensity by angles in radians: to the nadir, and about it.
double lopsided(double v, double h) {
  return (1.2 + std::cos(v)) * (1 + 0.4 * std::sin(v) * std::cos(h) + 0.3 * std::sin(v) * std::sin(h)) / 3.3;
}

LightDistribution lopsided_distribution() {
  LightDistribution result;
  for (int v = 0; v <= 180; v += 3) result.vertical.push_back(v);
  for (int h = 0; h <= 360; h += 5) result.horizontal.push_back(h);
  for (const double h : result.horizontal)
    for (const double v : result.vertical) result.intensity.push_back(float(lopsided(v * kPi / 180, h * kPi / 180)));
  return result;
}

/// The lamp hangs down, with C0 along +X and so C90 along -Z.
Light lamp_at(const Vec3d& position) {
  Light light = light_at(position);
  light.distribution = 0;
  return light;
}

EnergyField solved(const PatchSet& scene, Transport& transport, bool display = false) {
  SolveConfig config;
  config.display = display;
  Progress progress({"test", true, ""});
  return solve(scene, config, transport, progress);
}

TEST(PhotometricLightsSolved, LightSmallReceiversByTheirIntensityAtTwentyAngles) {
  const Vec3d center(1, 2, 3);
  PatchScene builder;
  struct Place {
    double v, h, distance;
  };
  std::vector<Place> places;
  for (int k = 0; k < 20; ++k) places.push_back({(4 + 9 * k) * kPi / 180, k * 77 * kPi / 180, 1 + 0.2 * k});
  for (const auto& [v, h, distance] : places) {
    const Vec3d to(std::sin(v) * std::cos(h), -std::cos(v), -std::sin(v) * std::sin(h));
    const Vec3d right = (to % Vec3d(0.3, 0.4, 0.8)).normalized() * 0.01, up = right % to;
    const Vec3d at = center + to * distance;
    builder.quad({at - right - up, at + right - up, at + right + up, at - right + up}, 1, 1, {0.0f});
    ASSERT_LT(Vec3d(builder.get().patches.back().normal) ^ to, -0.99) << "faces the lamp";
  }
  PatchSet& scene = builder.get();
  scene.distributions = {lopsided_distribution()};
  scene.lights = {lamp_at(center)};
  for (const double radius : {0.0, 0.05}) {
    scene.lights[0].radius = radius;
    Transport transport;
    const EnergyField energy = solved(scene, transport);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto& [v, h, distance] = places[k];
      const double expected = 10 * lopsided(v, h) / (distance * distance);
      EXPECT_NEAR(energy.groups[0].direct[k].x, expected, 0.01 * expected) << radius << " " << k;
    }
  }
}

TEST(PhotometricLightsSolved, ConserveTheirPower) {
  PatchScene builder;
  builder.room(1, 8, {0.6f});
  PatchSet& scene = builder.get();
  scene.distributions = {lopsided_distribution()};
  scene.lights = {lamp_at({0.2, 0.3, -0.4})};
  scene.lights[0].radius = 0.1;
  Transport transport;
  const EnergyField energy = solved(scene, transport);
  double power = 0, received = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double v = (i + 0.5) * kPi / kSteps, h = (j + 0.5) * 2 * kPi / kSteps;
      power += 10 * lopsided(v, h) * std::sin(v) * (kPi / kSteps) * (2 * kPi / kSteps);
    }
  for (std::size_t i = 0; i < scene.patches.size(); ++i)
    received += scene.patches[i].area * energy.groups[0].direct[i].x;
  EXPECT_NEAR(received / power, 1, 0.005);
}

TEST(PhotometricLightsSolved, OfAnotherFileCastTheRaysOfTheirLightOnly) {
  PatchScene builder;
  builder.room(1, 6, {0.5f});
  PatchSet& scene = builder.get();
  scene.light_groups = {"a", "b"};
  scene.distributions = {lopsided_distribution()};
  scene.lights = {lamp_at({0.2, 0.3, -0.4}), light_at({-0.5, 0.5, 0.5})};
  scene.lights[1].light_group = 1;
  scene.geometry_key = "geometry";
  Transport transport;
  const EnergyField first = solved(scene, transport, true);
  EXPECT_EQ(solved(scene, transport, true).rays, 0);
  scene.distributions[0].intensity[7] *= 0.5f;
  const EnergyField other = solved(scene, transport, true);
  EXPECT_GT(other.rays, 0);
  EXPECT_LT(other.rays, first.rays / 4);
  EXPECT_EQ(other.groups[1].direct, first.groups[1].direct);
  scene.lights[0].across = {0, 0, 1};
  const EnergyField turned = solved(scene, transport, true);
  EXPECT_GT(turned.rays, 0);
  EXPECT_NE(turned.groups[0].direct, other.groups[0].direct);
}

TEST(PhotometricLightsSolved, AreMirroredWithTheirDistribution) {
  // The light of the image behind the mirror is that of a lamp there whose distribution is mirrored at x = 2.
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  builder.quad({{{2, 0, -9}, {2, 0, 9}, {2, 9, 9}, {2, 9, -9}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  PatchSet& scene = builder.get();
  scene.distributions = {lopsided_distribution()};
  scene.lights = {lamp_at({0.5, 2, 0.25})};
  scene.lights[0].direction = Vec3d(0.3, -1, 0.2).normalized();
  scene.lights[0].across = (Vec3d(0, 0, 1) % scene.lights[0].direction).normalized();
  const RayScene rays(scene);
  const DirectLight light(scene, rays, explicit_emitters(scene).back());
  const DirectLight image = light.image(PlaneMirror(scene, rays, 0));
  for (const double x : {-3.0, 0.3, 1.6})
    EXPECT_NEAR(image.form_factor({4 - x, 0, 0.5}, {0, 1, 0}), light.form_factor({x, 0, 0.5}, {0, 1, 0}), 1e-9);
}

}  // namespace
}  // namespace patchlight
