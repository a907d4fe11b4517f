// Scenes with closed-form solutions, at default settings except the tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "pipeline/optics/lights/direct_light.h"
#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

EnergyField solve_quietly(const PatchSet& scene) {
  SolveConfig config;
  config.tolerance = 1e-6;
  Progress progress({"test", true, ""});
  return solve(scene, config, progress);
}

/// Area-weighted mean irradiance of a primitive, W/m2.
double mean_irradiance(const PatchSet& scene, const EnergyField& energy, int primitive) {
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    if (patch.primitive != primitive) continue;
    for (const auto& group : energy.groups) sum += patch.area * double(group.direct[i].y + group.indirect[i].y);
    area += patch.area;
  }
  return sum / area;
}

/// Relative RMS error of a primitive's patches against a known profile.
double profile_error(const PatchSet& scene, const EnergyField& energy, int primitive,
                     const std::function<double(const Vec3d&)>& exact) {
  double square = 0, norm = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    if (patch.primitive != primitive) continue;
    const double known = exact(patch.center);
    square += patch.area * std::pow(energy.groups[0].direct[i].y + energy.groups[0].indirect[i].y - known, 2);
    norm += patch.area * known * known;
  }
  return std::sqrt(square / norm);
}

const std::array<Vec3d, 4> kFloor{{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}};    // lit upwards
const std::array<Vec3d, 4> kCeiling{{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}};  // lit downwards
const std::array<Vec3d, 4> kWall{{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}};     // lit towards +x

TEST(ClosedForm, ParallelAndPerpendicularSquares) {
  PatchScene builder;
  builder.quad(kFloor, 20, 20, {0.0f, 0.0f});
  builder.quad(kCeiling, 20, 20, {0.0f, 1.0f});
  EXPECT_NEAR(mean_irradiance(builder.get(), solve_quietly(builder.get()), 0), 0.199824895698387, 0.003 * 0.2);
  PatchScene corner;
  corner.quad(kFloor, 20, 20, {0.0f, 0.0f});
  corner.quad(kWall, 20, 20, {0.0f, 1.0f});
  EXPECT_NEAR(mean_irradiance(corner.get(), solve_quietly(corner.get()), 0), 0.200043776, 0.003 * 0.2);
}

TEST(ClosedForm, ConcentricSpheres) {
  PatchScene builder;
  builder.sphere({1, 2, 3}, -1, 24, 36, {0.0f, 0.0f});
  builder.sphere({1, 2, 3}, 0.5, 12, 24, {0.0f, 2.0f});
  const EnergyField energy = solve_quietly(builder.get());
  EXPECT_NEAR(mean_irradiance(builder.get(), energy, 0), 0.5, 0.003 * 0.5);
  EXPECT_LT(profile_error(builder.get(), energy, 0, [](const Vec3d&) { return 0.5; }), 0.01);
}

TEST(ClosedForm, EmittingSphereLightsASphereInsideIt) {
  PatchScene builder;
  builder.sphere({0, 0, 0}, -2, 16, 24, {0.5f, 1.0f});
  builder.sphere({0.3, 0.2, 0.1}, 0.5, 8, 12, {0.5f, 0.0f});
  const EnergyField energy = solve_quietly(builder.get());
  // Radiosity b of the outer and c of the inner: c = b / 2, b = 1 + (b (1 - 1/16) + c / 16) / 2.
  const double b = 1 / (1 - 0.5 * (15.0 / 16 + 0.5 / 16));
  EXPECT_NEAR(mean_irradiance(builder.get(), energy, 1), b, 0.005 * b);
  EXPECT_LT(profile_error(builder.get(), energy, 1, [&](const Vec3d&) { return b; }), 0.01);
}

TEST(ClosedForm, AMirrorIsAWindowToTheVirtualImage) {
  PatchScene builder, image;
  builder.get().materials.push_back({"mirror", Color(0.8f), 0.0f});
  builder.quad({{{-0.25, 0, 0.5}, {-0.25, 0, 1}, {0.25, 0, 1}, {0.25, 0, 0.5}}}, 6, 6, {0.0f, 0.0f});
  builder.quad({{{-4, -1, 0}, {4, -1, 0}, {4, 7, 0}, {-4, 7, 0}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-1, 1, 2}, {-1, 2, 2}, {1, 2, 2}, {1, 1, 2}}}, 4, 4, {0.0f, 3.0f});
  image.quad({{{-1, 1, -2}, {1, 1, -2}, {1, 2, -2}, {-1, 2, -2}}}, 1, 1, {0.0f, 3.0f});
  const PatchSet& scene = builder.get();
  const RayScene rays(image.get());
  const DirectLight virtual_lamp(image.get(), rays, explicit_emitters(image.get()).at(0));
  double exact = 0, seen = 0;
  SolveConfig config;
  config.rays = 1 << 16;
  Progress progress({"test", true, ""});
  const EnergyField energy = solve(scene, config, progress);
  for (int i = 0; i < 36; ++i) {
    exact += 3 * 0.8 * virtual_lamp.form_factor(scene.patches[i].center, {0, 1, 0}) / 36;
    seen += energy.groups[0].indirect[i].y / 36;
  }
  EXPECT_NEAR(seen, exact, 0.005 * exact);
}

/// Mean irradiance, over the emission, of the floor of a room with a sphere and a panel light.
double floor_irradiance(double scale, const Vec3d& shift, double turn, float emission, int cells) {
  PatchScene builder;
  const auto place = [&](const Vec3d& p) {
    const Vec3d turned(p.x * std::cos(turn) - p.z * std::sin(turn), p.y, p.x * std::sin(turn) + p.z * std::cos(turn));
    return turned * scale + shift;
  };
  const auto quad = [&](const std::array<Vec3d, 4>& c, int n, const PatchScene::Surface& surface) {
    builder.quad({place(c[0]), place(c[1]), place(c[2]), place(c[3])}, n, n, surface);
  };
  quad({{{-1, -1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, -1, -1}}}, cells, {0.6f, 0.0f});
  quad({{{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}}, cells, {0.8f, 0.0f});
  quad({{{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}}, cells, {0.7f, 0.0f});
  quad({{{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}}, cells, {0.3f, 0.0f});
  quad({{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, cells, {0.7f, 0.0f});
  quad({{{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}}, cells, {0.7f, 0.0f});
  quad({{{-0.3, 0.9, -0.3}, {0.3, 0.9, -0.3}, {0.3, 0.9, 0.3}, {-0.3, 0.9, 0.3}}}, 2, {0.0f, emission});
  builder.sphere(place({0.2, -0.4, 0.1}), 0.4 * scale, cells, 2 * cells, {0.5f, 0.0f});
  return mean_irradiance(builder.get(), solve_quietly(builder.get()), 0) / emission;
}

TEST(Invariance, OfScaleTurnPlaceEmissionAndPatches) {
  const double usual = floor_irradiance(1, Vec3d(0.0), 0, 1.0f, 12);
  EXPECT_NEAR(floor_irradiance(1e-3, Vec3d(0.0), 0, 1.0f, 12) / usual, 1, 1e-3);
  EXPECT_NEAR(floor_irradiance(1e3, Vec3d(0.0), 0, 1.0f, 12) / usual, 1, 1e-3);
  EXPECT_NEAR(floor_irradiance(1, Vec3d(0.0), 0.7, 1.0f, 12) / usual, 1, 1e-3);
  EXPECT_NEAR(floor_irradiance(1, Vec3d(1e4, -1e4, 1e4), 0, 1.0f, 12) / usual, 1, 1e-3);
  EXPECT_NEAR(floor_irradiance(1, Vec3d(0.0), 0, 1e-6f, 12) / usual, 1, 1e-3);
  EXPECT_NEAR(floor_irradiance(1, Vec3d(0.0), 0, 1e6f, 12) / usual, 1, 1e-3);
  EXPECT_NEAR(floor_irradiance(1, Vec3d(0.0), 0, 1.0f, 17) / usual, 1, 5e-3);
}

TEST(Invariance, OfEmitterAndReceiverSwapped) {
  const auto received = [](int emitter) {
    PatchScene builder;
    builder.quad({{{0.2, 0, 0.1}, {0.2, 0, 0.9}, {1, 0, 0.9}, {1, 0, 0.1}}}, 8, 8, {0.5f, emitter == 0 ? 1.0f : 0.0f});
    builder.quad(kWall, 10, 10, {0.5f, emitter == 1 ? 1.0f : 0.0f});
    builder.sphere({0.5, 0.4, 0.5}, 0.2, 6, 12, {0.7f, 0.0f});
    const EnergyField energy = solve_quietly(builder.get());
    return mean_irradiance(builder.get(), energy, 1 - emitter) * (emitter == 0 ? 1.0 : 0.64);  // W
  };
  EXPECT_NEAR(received(0) / received(1), 1, 3e-3);
}

}  // namespace
}  // namespace patchlight
