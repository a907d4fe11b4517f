// Slowly converging light, and scenes without light.
#include <algorithm>
#include <tuple>

#include "tests/end_to_end/hard_cases/hard_cases.h"

namespace patchlight::test {
namespace {

PatchSet furnace(float reflectance, int cells) {
  PatchScene builder;
  builder.room(1, cells, {reflectance, 1.0f});
  return builder.get();
}

TEST_F(HardCases, ClosedFurnaces) {
  for (const float rho : {0.0f, 0.5f, 0.9f})
    expect_exact(fmt::format("furnace, reflectance {}", rho), furnace(rho, 6),
                 [=](const Patch&) { return 1 / (1 - rho); }, {1e-3, 1e-3, 0.05, 0.15});
}

TEST_F(HardCases, ReflectancesNearOne) {
  for (const float rho : {0.999f, 0.9999f}) {
    expect_exact(fmt::format("furnace, reflectance {}", rho), furnace(rho, 4),
                 [=](const Patch&) { return 1 / (1 - rho); }, {1e-3, 1e-3, 0.01, 0.3});
    PatchScene builder;
    builder.room(1, 4, {rho, 0.0f});
    PatchSet& scene = builder.get();
    scene.primitives[0].light_group = 0;
    for (int i = 0; i < 16; ++i) scene.patches[i].emission = Color(1.0f);
    // All walls together absorb the power that one of them emits.
    expect_each(fmt::format("power absorbed, one wall lit, {}", rho), {0.01, 0.02, 5e-3, 0.3},
                [&](const Configuration& configuration) {
                  const EnergyField energy = solved(scene, configuration);
                  double absorbed = 0;
                  for (std::size_t i = 0; i < scene.patches.size(); ++i)
                    absorbed += scene.patches[i].area * irradiance_at(energy, i) * (1 - rho);
                  return std::abs(absorbed / 4 - 1);
                });
  }
}

constexpr PatchScene::Surface kWhite{0.9999f, 0.0f};

/// Adds a lamp in one of two rooms, and two walls between the rooms, at a distance of 2 cm, with a slit under the
/// ceiling.
void add_walls_and_lamp(PatchScene& builder) {
  builder.quad({{{0.01, -1, -1}, {0.01, 0.9, -1}, {0.01, 0.9, 1}, {0.01, -1, 1}}}, 5, 5, kWhite);
  builder.quad({{{-0.01, -1, -1}, {-0.01, -1, 1}, {-0.01, 0.9, 1}, {-0.01, 0.9, -1}}}, 5, 5, kWhite);
  builder.quad({{{-0.9, 0.9, -0.3}, {-0.5, 0.9, -0.3}, {-0.5, 0.9, 0.3}, {-0.9, 0.9, 0.3}}}, 2, 2, {0.0f, 9.0f});
}

PatchSet two_rooms() {
  PatchScene builder;
  builder.room(1, 6, kWhite);
  add_walls_and_lamp(builder);
  return builder.get();
}

/// two_rooms() with patches that end at the dividing walls.
PatchSet two_rooms_cut_at_the_walls() {
  PatchScene builder;
  builder.quad({{{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}}, 6, 6, kWhite);
  builder.quad({{{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}}, 6, 6, kWhite);
  for (const auto& [x, end, cells] : {std::tuple(-1.0, -0.01, 3), {-0.01, 0.01, 1}, {0.01, 1.0, 3}}) {
    builder.quad({{{x, -1, -1}, {x, -1, 1}, {end, -1, 1}, {end, -1, -1}}}, 6, cells, kWhite);
    builder.quad({{{x, 1, -1}, {end, 1, -1}, {end, 1, 1}, {x, 1, 1}}}, cells, 6, kWhite);
    builder.quad({{{x, -1, -1}, {end, -1, -1}, {end, 1, -1}, {x, 1, -1}}}, cells, 6, kWhite);
    builder.quad({{{x, -1, 1}, {x, 1, 1}, {end, 1, 1}, {end, -1, 1}}}, 6, cells, kWhite);
  }
  add_walls_and_lamp(builder);
  return builder.get();
}

TEST_F(HardCases, PatchesThatExtendBehindAWall) {
  const auto far_room = [](const PatchSet& scene) {
    SolveConfig config = hard_case_config();
    config.rays = 1 << 15;
    const EnergyField energy = solve_quietly(scene, kConfigurations[0], config);
    double power = 0, area = 0;
    for (std::size_t i = 0; i < scene.patches.size(); ++i)
      if (const Patch& patch = scene.patches[i]; patch.center.x > 0.4) {
        power += patch.area * irradiance_at(energy, i);
        area += patch.area;
      }
    return power / area;
  };
  EXPECT_NEAR(far_room(two_rooms()) / far_room(two_rooms_cut_at_the_walls()), 1, 0.01);
}

TEST_F(HardCases, SlowlyConvergingLightBehindASlit) {
  const PatchSet scene = two_rooms();
  SolveConfig many = hard_case_config();
  many.rays = 1 << 15;
  many.seed = 2;
  const EnergyField truth = solve_quietly(scene, kConfigurations[0], many);
  expect_exact("two rooms with a slit between them, 0.9999", scene,
               [&](const Patch& p) { return irradiance_at(truth, std::size_t(&p - scene.patches.data())); },
               {0.02, 0.5, 0.5, 0.5});
}

TEST_F(HardCases, InsideOfASphere) {
  PatchScene builder;
  builder.sphere({1, 2, 3}, -1, 12, 18, {0.9f, 0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[0].light_group = 0;
  for (std::size_t i = 0; i < scene.patches.size() / 2; ++i) scene.patches[i].emission = Color(1.0f);
  expect_exact("inside of a sphere, upper half lit", scene, [](const Patch&) { return 0.5 / (1 - 0.9f); },
               {5e-3, 1e-3, 0.02, 5e-3});
}

TEST_F(HardCases, NoEmitter) {
  PatchScene builder;
  builder.room(1, 4, {0.5f, 0.0f});
  builder.get().light_groups.clear();
  expect_each("no emitter", {0, 0, 0, 0}, [&](const Configuration& configuration) {
    const EnergyField energy = solved(builder.get(), configuration);
    EXPECT_NE(warnings_.find("nothing in the scene emits light"), std::string::npos);
    double largest = 0;
    for (const Color& b : radiosity(builder.get(), energy)) largest = std::max(largest, std::abs(double(b.y)));
    return largest;
  });
}

/// A room of side 2 whose walls at -x and +x have a specular reflectance of `mirror`; 0: black.
PatchSet mirror_room(float mirror) {
  PatchScene builder;
  builder.room(1, 6, {0.5f, 1.0f});
  PatchSet& scene = builder.get();
  scene.materials.push_back({"mirror", Color(mirror), 0.0f});
  for (int k = 0; k < 2; ++k) {
    scene.primitives[k].material = 1;
    scene.primitives[k].light_group = -1;
  }
  for (int i = 0; i < 72; ++i) scene.patches[i].emission = scene.patches[i].reflectance = Color(0.0f);
  return scene;
}

TEST_F(HardCases, MirrorFacingMirror) {
  const PatchSet scene = mirror_room(1.0f);
  const EnergyField black = solve_quietly(mirror_room(0.0f), kConfigurations[0]);
  // The mirrors are perfect, and light between them ends on the other walls: a furnace. Only `matrix` over rays follows
  // mirrors; for the other configurations they are black.
  expect_each("mirrors face each other", {0.01, 0.02, 0.05, 0.1}, [&](const Configuration& configuration) {
    const bool follows_mirrors = &configuration == &kConfigurations[0];
    return irradiance_error(scene, solved(scene, configuration), [&](const Patch& p) {
      if (p.primitive < 2) return kNotCounted;
      return follows_mirrors ? 2.0 : irradiance_at(black, std::size_t(&p - scene.patches.data()));
    });
  });
}

}  // namespace
}  // namespace patchlight::test
