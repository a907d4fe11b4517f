// Occluders that must not leak light, and scenes that differ only in size, position or strength.
#include <algorithm>

#include "tests/end_to_end/hard_cases/hard_cases.h"
#include "tests/end_to_end/hard_cases/lambert_factor.h"

namespace patchlight::test {
namespace {

/// A room from -1 to 1 that is divided by a wall at x = 0; the face at -x emits. The other faces extend across both
/// halves (`extends_through`), or end at the dividing wall, which then overlaps them by a centimetre.
PatchSet divided_room(double thickness, bool extends_through) {
  PatchScene builder;
  const PatchScene::Surface white{0.9f, 0.0f};
  builder.quad({{{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}}, 8, 8, {0.9f, 1.0f});
  builder.quad({{{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}}, 8, 8, white);
  const double x = thickness / 2, h = extends_through ? 1 : 1.01;
  for (const double side : {-1.0, 1.0}) {
    const double a = side < 0 ? -1 : x, b = extends_through || side > 0 ? 1 : -x;
    const int n = extends_through ? 8 : 4;
    builder.quad({{{a, -1, -1}, {a, -1, 1}, {b, -1, 1}, {b, -1, -1}}}, 8, n, white);
    builder.quad({{{a, 1, -1}, {b, 1, -1}, {b, 1, 1}, {a, 1, 1}}}, n, 8, white);
    builder.quad({{{a, -1, -1}, {b, -1, -1}, {b, 1, -1}, {a, 1, -1}}}, n, 8, white);
    builder.quad({{{a, -1, 1}, {a, 1, 1}, {b, 1, 1}, {b, -1, 1}}}, 8, n, white);
    if (extends_through) break;
  }
  const int right = builder.quad({{{x, -h, -h}, {x, h, -h}, {x, h, h}, {x, -h, h}}}, 5, 5, white);
  const int left = builder.quad({{{-x, -h, -h}, {-x, -h, h}, {-x, h, h}, {-x, h, -h}}}, 5, 5, white);
  PatchSet& scene = builder.get();
  if (thickness == 0) {
    scene.primitives[right].back = left;
    scene.primitives[left].back = right;
  }
  return scene;
}

TEST_F(HardCases, ThinWalls) {
  struct Wall {
    const char* name;
    double thickness;
    bool extends_through;
    Limits limits;
  };
  // A rasteriser snaps corners to a subpixel grid, and a hemicube identifies patches by interpolated (u,v): a cell at
  // the foot of the wall may count for the patch on the other side.
  for (const Wall& wall :
       {Wall{"light through a wall of no thickness", 0, true, {0, 1e-4, 0, 1e-4}},
        {"light through a wall of 0.1 mm", 1e-4, true, {0, 1e-4, 0, 1e-4}},
        {"light through a wall of 1 cm at which all other surfaces end", 0.01, false, {0, 0, 0, 0}}}) {
    const PatchSet scene = divided_room(wall.thickness, wall.extends_through);
    expect_each(wall.name, wall.limits, [&](const Configuration& configuration) {
      const EnergyField energy = solved(scene, configuration);
      double dark = 0, lit = 0;
      for (std::size_t i = 0; i < scene.patches.size(); ++i) {
        const bool behind = scene.patches[i].center.x + 0.01 * scene.patches[i].normal.x > 0;
        (behind ? dark : lit) += irradiance_at(energy, i);
      }
      EXPECT_GT(lit, 100.0);
      return dark / lit;
    });
  }
}

constexpr double kGap = 1e-3;  // m, below the block

/// A black floor of 10 x 10 patches, which come first, and a black block above 4 x 4 of them.
PatchScene block_above_floor() {
  PatchScene builder;
  const double a = 0.3, b = 0.7, low = kGap, high = 0.2;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 10, 10, {0.0f, 0.0f});
  for (const Corners& c : {Corners{{{a, low, a}, {b, low, a}, {b, low, b}, {a, low, b}}},
                           {{{a, high, a}, {a, high, b}, {b, high, b}, {b, high, a}}},
                           {{{a, low, a}, {a, low, b}, {a, high, b}, {a, high, a}}},
                           {{{b, low, a}, {b, high, a}, {b, high, b}, {b, low, b}}},
                           {{{a, low, a}, {a, high, a}, {b, high, a}, {b, low, a}}},
                           {{{a, low, b}, {b, low, b}, {b, high, b}, {a, high, b}}}})
    builder.quad(c, 2, 2, {0.0f, 0.0f});
  return builder;
}

bool under_the_block(const Patch& patch) {
  return patch.primitive == 0 && std::max(std::abs(patch.center.x - 0.5), std::abs(patch.center.z - 0.5)) < 0.2;
}

TEST_F(HardCases, ContactShadow) {
  PatchScene sky = block_above_floor();
  sky.sphere({0.5, 0, 0.5}, -0.8, 16, 24, {0.0f, 1.0f});
  const PatchSet& scene = sky.get();
  std::vector<Corners> block;
  for (int k = 1; k <= 6; ++k) block.push_back(scene.primitives[k].corners);
  expect_exact("floor under a sky, block 1 mm above", scene,
               [&](const Patch& p) { return p.primitive == 0 ? 1 - patch_factor(scene, p, block) : kNotCounted; },
               {0.02, 0.06, 0.06, 0.03});

  PatchScene lamp = block_above_floor();
  lamp.quad({{{0.4, 1, 0.4}, {0.6, 1, 0.4}, {0.6, 1, 0.6}, {0.4, 1, 0.6}}}, 3, 3, {0.0f, 1.0f});
  expect_each("lamp's light under the block", {0, 0, 0, 0}, [&](const Configuration& configuration) {
    const EnergyField energy = solved(lamp.get(), configuration);
    double dark = 0, lit = 0;
    for (std::size_t i = 0; i < 100; ++i)
      (under_the_block(lamp.get().patches[i]) ? dark : lit) += irradiance_at(energy, i);
    EXPECT_GT(lit, 0.5);
    return dark / lit;
  });
}

/// A room with a ball in it and a panel light.
PatchSet lit_room(double scale, const Vec3d& shift, float emission) {
  PatchScene builder;
  builder.room(1, 8, {0.6f, 0.0f});
  builder.quad({{{-0.3, 0.9, -0.3}, {0.3, 0.9, -0.3}, {0.3, 0.9, 0.3}, {-0.3, 0.9, 0.3}}}, 2, 2, {0.2f, emission});
  builder.sphere({0.2, -0.4, 0.1}, 0.4, 8, 12, {0.5f, 0.0f});
  PatchSet& scene = builder.get();
  for (Primitive& p : scene.primitives) {
    p.sphere_radius *= scale;
    if (p.shape == Primitive::Shape::sphere) p.sphere_center = p.sphere_center * scale + shift;
    if (p.shape == Primitive::Shape::quad)
      for (Vec3d& corner : p.corners) corner = corner * scale + shift;
  }
  for (Patch& patch : scene.patches) {
    patch.center = patch.center * scale + shift;
    patch.area *= scale * scale;
  }
  return scene;
}

TEST_F(HardCases, ResultsScaleWithSizePositionAndStrength) {
  struct Change {
    const char* name;
    double scale;
    Vec3d shift;
    float emission;
  };
  SolveConfig config = hard_case_config();
  config.tolerance = 1e-3;
  const PatchSet usual = lit_room(1, Vec3d(0.0), 1.0f);
  for (const Change& c : {Change{"room scaled by 1e-3", 1e-3, Vec3d(0.0), 1.0f},
                          {"room scaled by 1e3", 1e3, Vec3d(0.0), 1.0f},
                          {"room moved 10 km", 1, Vec3d(1e4, -1e4, 1e4), 1.0f},
                          {"emission 1e-6", 1, Vec3d(0.0), 1e-6f},
                          {"emission 1e6", 1, Vec3d(0.0), 1e6f}})
    expect_same(
        c.name, lit_room(c.scale, c.shift, c.emission), usual, [&](const Patch&) { return c.emission; },
        {1e-3, 1e-3, 1e-3, 1e-3}, config);
}

}  // namespace
}  // namespace patchlight::test
