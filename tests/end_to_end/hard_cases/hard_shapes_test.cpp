// Shapes and positions with difficult form factors.
#include "tests/end_to_end/hard_cases/hard_cases.h"
#include "tests/end_to_end/hard_cases/lambert_factor.h"

namespace patchlight::test {
namespace {

const Corners kFloor{{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}};
const Corners kWall{{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}};

TEST_F(HardCases, SurfacesThatTouch) {
  PatchScene builder;
  builder.quad(kFloor, 9, 9, {0.0f, 0.0f});
  builder.quad(kWall, 9, 9, {0.0f, 1.0f});
  gathered_light(builder.get());
  const PatchSet& scene = builder.get();
  expect_exact("walls that touch", scene,
               [&](const Patch& p) { return p.primitive == 0 ? patch_factor(scene, p, {kWall}) : kNotCounted; },
               {0.02, 0.06, 0.06, 0.06});
}

TEST_F(HardCases, SurfacesThatNearlyTouch) {
  PatchScene builder;
  const Corners lid{{{0, 1e-3, 0}, {1, 1e-3, 0}, {1, 1e-3, 1}, {0, 1e-3, 1}}};
  builder.quad(kFloor, 9, 9, {0.0f, 0.0f});
  builder.quad(lid, 9, 9, {0.0f, 1.0f});
  gathered_light(builder.get());
  const PatchSet& scene = builder.get();
  expect_exact("plates 1 mm apart", scene,
               [&](const Patch& p) { return p.primitive == 0 ? patch_factor(scene, p, {lid}) : kNotCounted; },
               {0.02, 0.02, 0.02, 0.02});
}

/// A closed duct of 10 m x 1 mm x 1 mm that emits inside. `slivers`: its long walls are cut along their diagonals.
PatchSet duct(bool slivers) {
  PatchScene builder;
  const PatchScene::Surface surface{0.5f, 1.0f};
  const double l = 10, w = 1e-3;
  for (const Corners& c : {Corners{{{0, 0, 0}, {0, 0, w}, {l, 0, w}, {l, 0, 0}}},
                           {{{0, w, 0}, {l, w, 0}, {l, w, w}, {0, w, w}}},
                           {{{0, 0, 0}, {l, 0, 0}, {l, w, 0}, {0, w, 0}}},
                           {{{0, 0, w}, {0, w, w}, {l, w, w}, {l, 0, w}}}}) {
    if (slivers) {
      builder.quad({c[0], c[1], c[2], c[2]}, 3, 3, surface);
      builder.quad({c[2], c[3], c[0], c[0]}, 3, 3, surface);
    } else {
      builder.quad(c, 3, 3, surface);
    }
  }
  builder.quad({{{0, 0, 0}, {0, w, 0}, {0, w, w}, {0, 0, w}}}, 1, 1, surface);
  builder.quad({{{l, 0, 0}, {l, 0, w}, {l, w, w}, {l, w, 0}}}, 1, 1, surface);
  return builder.get();
}

TEST_F(HardCases, SliversAndLongRectangles) {
  for (const bool slivers : {false, true})
    expect_exact(slivers ? "furnace of slivers 10 m x 1 mm" : "furnace of rectangles 10 m x 1 mm", duct(slivers),
                 [](const Patch&) { return 2.0; }, {1e-3, 0.02, 0.03, 0.2});
  PatchScene builder;
  const Corners strip{{{0, 1, 0.5}, {10, 1, 0.5}, {10, 1, 0.501}, {0, 1, 0.501}}};
  builder.quad({{{4, 0, 0}, {4, 0, 1}, {6, 0, 1}, {6, 0, 0}}}, 8, 8, {0.0f, 0.0f});
  builder.quad(strip, 100, 1, {0.0f, 1.0f});
  const PatchSet& scene = builder.get();
  expect_exact("lamp of 10 m x 1 mm", scene,
               [&](const Patch& p) { return p.primitive == 0 ? patch_factor(scene, p, {strip}) : kNotCounted; },
               {1e-3, 1e-3, 0.08, 0.01});
}

TEST_F(HardCases, PolesOfSpheres) {
  PatchScene nested, lit;
  nested.sphere({1, 2, 3}, -1, 12, 18, {0.0f, 0.0f});
  nested.sphere({1, 2, 3}, 0.5, 12, 18, {0.0f, 2.0f});
  gathered_light(nested.get());
  expect_exact("poles about a ball", nested.get(),
               [](const Patch& p) { return p.primitive == 0 && (p.v0 == 0 || p.v1 == 1) ? 0.5 : kNotCounted; },
               {0.01, 0.01, 0.06, 0.03});
  const Corners lamp{{{-0.5, 1, -0.5}, {0.5, 1, -0.5}, {0.5, 1, 0.5}, {-0.5, 1, 0.5}}};
  lit.sphere(Vec3d(0.0), 0.5, 12, 18, {0.0f, 0.0f});
  lit.quad(lamp, 9, 9, {0.0f, 1.0f});
  gathered_light(lit.get());
  const PatchSet& scene = lit.get();
  expect_exact(
      "pole under a lamp", scene,
      [&](const Patch& p) { return p.primitive == 0 && p.v0 == 0 ? patch_factor(scene, p, {lamp}) : kNotCounted; },
      {0.02, 0.03, 0.08, 0.02});
}

double power_on(const PatchSet& scene, const EnergyField& energy, int primitive) {
  double power = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i)
    if (scene.patches[i].primitive == primitive) power += scene.patches[i].area * irradiance_at(energy, i);
  return power;
}

TEST_F(HardCases, CoplanarOverlaps) {
  PatchScene once, twice, flush;
  for (PatchScene* builder : {&once, &twice}) {
    builder->room(1, 6, {0.7f, 0.0f});
    PatchSet& scene = builder->get();
    scene.primitives[0].light_group = 0;
    for (int i = 0; i < 36; ++i) scene.patches[i].emission = Color(1.0f);
  }
  twice.quad({{{-0.6, -1, -0.7}, {-0.6, -1, 0.8}, {0.5, -1, 0.8}, {0.5, -1, -0.7}}}, 4, 4, {0.7f, 0.0f});
  expect_same("floor twice in one plane: the other walls", twice.get(), once.get(),
              [](const Patch& p) { return p.primitive == 2 || p.primitive == 6 ? kNotCounted : 1.0; },
              {5e-3, 5e-3, 0.02, 0.02});
  // Both floors gather full rows, but a shot hits only one of them; so for shooting their total power is compared.
  expect_each("floor twice in one plane: the floor", {5e-3, 5e-3, 0.02, 0.02}, [&](const Configuration& configuration) {
    const PatchSet& scene = twice.get();
    const EnergyField before = solve_quietly(once.get(), configuration), energy = solved(scene, configuration);
    if (std::string(configuration.method) == "progressive")
      return std::abs((power_on(scene, energy, 2) + power_on(scene, energy, 6)) / power_on(once.get(), before, 2) - 1);
    return irradiance_error(scene, energy, [&](const Patch& p) {
      return p.primitive == 2 ? irradiance_at(before, std::size_t(&p - scene.patches.data())) : kNotCounted;
    });
  });

  const Corners lamp{{{0.3, 1, 0.4}, {0.6, 1, 0.4}, {0.6, 1, 0.7}, {0.3, 1, 0.7}}};
  flush.quad(kFloor, 8, 8, {0.0f, 0.0f});
  flush.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 8, 8, {0.0f, 0.0f});
  for (const int lamps : {1, 2}) {
    flush.quad(lamp, 3, 3, {0.0f, 1.0f});
    const PatchSet& scene = flush.get();
    expect_exact(
        lamps == 1 ? "lamp in the ceiling's plane" : "two lamps in one place, each counted", scene,
        [&](const Patch& p) { return p.primitive == 0 ? lamps * patch_factor(scene, p, {lamp}) : kNotCounted; },
        {1e-3, 1e-3, 0.05, 0.01});
  }
}

}  // namespace
}  // namespace patchlight::test
