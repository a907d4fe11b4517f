// What cut-outs let through, keep back and give off, against closed forms.
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

/// A floor and a lamp above, unit squares at distance 1, and between them a black screen of both sides that hides the
/// one from the other, with `count` x `count` squares every other of which is a hole.
PatchSet screened(int count) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 8, 8, {0.0f});
  builder.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 8, 8, {0.0f, 1.0f});
  builder.quad({{{0, 0.5, 0}, {0, 0.5, 1}, {1, 0.5, 1}, {1, 0.5, 0}}}, 4, 4, {0.0f});
  builder.quad({{{1, 0.5, 0}, {1, 0.5, 1}, {0, 0.5, 1}, {0, 0.5, 0}}}, 4, 4, {0.0f});
  PatchSet scene = builder.get();
  for (const int side : {2, 3}) test::alpha_masked(scene, side, test::checkers(count), 0.5f);
  test::make_sides(scene, 2, 3);
  scene.texcoords.assign(4, kOwnTexcoords);
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

TEST(AlphaMasks, LightGoesThroughEveryHoleToWhereItLeads) {
  // A lamp's small square straight above a hole of the screen's that stands on the floor, and one above a square of it.
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 2, 2, {0.0f});
  builder.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 1, 1, {0.0f, 1.0f});
  builder.quad({{{0, 1e-3, 0}, {0, 1e-3, 1}, {1, 1e-3, 1}, {1, 1e-3, 0}}}, 1, 1, {0.0f});
  PatchSet scene = builder.get(), open = scene;
  test::alpha_masked(scene, 2, test::checkers(2), 0.5f);
  std::erase_if(open.patches, [](const Patch& patch) { return patch.primitive == 2; });
  open.primitives.pop_back();
  for (const Method& by : {kMethods[0], kMethods[1]}) {
    const EnergyField energy = solve_by(scene, by), bare = solve_by(open, by);
    for (std::size_t i = 0; i < 4; ++i) {
      const bool hole = i == 1 || i == 2;
      const double whole = bare.groups[0].direct[i].y;
      EXPECT_NEAR(energy.groups[0].direct[i].y, hole ? whole : 0.0, 5 * by.tolerance * whole) << by.method << " " << i;
    }
  }
}

/// The inside of a ball where everything emits and reflects alike, by the rows, with a perforated baffle across it.
PatchSet furnace(float reflectance) {
  PatchScene builder;
  builder.sphere({0, 0, 0}, -1.5, 8, 12, {reflectance, 1.0f});
  builder.quad({{{0, -0.9, -0.9}, {0, 0.9, -0.9}, {0, 0.9, 0.9}, {0, -0.9, 0.9}}}, 4, 4, {reflectance, 1.0f});
  builder.quad({{{0, 0.9, -0.9}, {0, -0.9, -0.9}, {0, -0.9, 0.9}, {0, 0.9, 0.9}}}, 4, 4, {reflectance, 1.0f});
  PatchSet scene = builder.get();
  for (const int side : {1, 2}) test::alpha_masked(scene, side, test::checkers(16), 0.5f);
  test::make_sides(scene, 1, 2);
  scene.texcoords.assign(3, kOwnTexcoords);
  scene.texcoords[2] = {Vec2f(1, 0), Vec2f(0, 0), Vec2f(0, 1), Vec2f(1, 1)};
  return scene;
}

TEST(AlphaMasks, AFurnaceWithAPerforatedBaffleGlowsAllOver) {
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

TEST(AlphaMasks, APerforatedLampGivesOffWhatIsThereOfIt) {
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

TEST(AlphaMasks, LightIsReflectedByWhatIsThereAlone) {
  // Under a lamp that fills the sky a white square, half of it cut out, sends to a black ceiling what half of it would.
  const auto sent = [](bool cut, const Method& by) {
    PatchScene builder;
    builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 4, 4, {0.8f});
    builder.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 4, 4, {0.0f, 1.0f});
    PatchSet scene = builder.get();
    if (cut) test::alpha_masked(scene, 0, test::checkers(32), 0.5f);
    return received(scene, solve_by(scene, by), 1);
  };
  for (const Method& by : kMethods)
    EXPECT_NEAR(sent(true, by) / sent(false, by), 0.5, std::max(0.02, by.tolerance))
        << by.method << " " << by.form_factors;
}

}  // namespace
}  // namespace patchlight
