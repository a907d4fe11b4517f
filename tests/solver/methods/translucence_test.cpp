#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr float kTranslucence = 0.4f, kSheet = 0.3f;  // what the sheet passes, and what it reflects

/// A sheet across the room from -half to half, of another grid on its back. Returns the index of its front, seen from
/// growing x.
int add_sheet(PatchScene& builder, double h, float emission = 0.0f) {
  PatchSet& scene = builder.get();
  scene.materials.push_back({"cloth"});
  scene.materials[1].translucence = Color(kTranslucence);
  const int front = builder.quad({{{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}}}, 6, 6, {kSheet, emission, 0, 1});
  const int back = builder.quad({{{0, h, -h}, {0, -h, -h}, {0, -h, h}, {0, h, h}}}, 4, 4, {kSheet, emission, 0, 1});
  scene.primitives[front].back = back;
  scene.primitives[back].back = front;
  return front;
}

/// Form factor between opposite faces of a cuboid, squares of edge 2 at distance 1 (Howell, C-11).
double between_squares() {
  const double x = 2, x2 = 1 + x * x;
  return 2 / (kPi * x * x) *
         (0.5 * std::log(x2 * x2 / (1 + 2 * x * x)) + 2 * x * std::sqrt(x2) * std::atan(x / std::sqrt(x2)) -
          2 * x * std::atan(x));
}

class Translucence : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  EnergyField solved(const PatchSet& scene) const {
    SolveConfig config;
    std::tie(config.method, config.form_factors) = GetParam();
    config.tolerance = 1e-5;
    config.rays = 512;
    Transport transport;
    Progress progress({"test", true, ""});
    return solve(scene, config, transport, progress);
  }
  /// Of single patches; progressive refinement is exact on average alone where patches are this large.
  double tolerance() const { return std::get<0>(GetParam()) == "matrix" ? 0.02 : 0.5; }
};

TEST_P(Translucence, SheetsInAFurnaceKeepItsLight) {
  PatchScene builder;
  builder.room(1, 6, {0.5f, 1.0f});
  const float absorbed = 1 - kSheet - kTranslucence;
  add_sheet(builder, 1, 2 * absorbed);  // of the irradiance 2 all around
  const EnergyField energy = solved(builder.get());
  const std::vector<Color> found = irradiance(energy.groups[0]);
  double mean = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].x, 2.0, 2 * tolerance()) << i << (i < 216 ? ", a wall" : ", the sheet");
    mean += double(found[i].x) / double(found.size());
  }
  EXPECT_NEAR(mean, 2.0, 0.02);
  if (energy.estimate) {
    EXPECT_LT(energy.estimate->balance, 0.01);
  }
}

TEST_P(Translucence, WallsBehindASheetGetWhatPasses) {
  PatchScene builder;
  builder.room(1, 6, {0.0f});
  const int front = add_sheet(builder, 1);
  PatchSet& scene = builder.get();
  scene.primitives[1].light_group = 0;  // the wall at x = 1, before the sheet
  for (int i = 36; i < 72; ++i) scene.patches[i].emission = Color(1.0f);
  const std::vector<Color> found = irradiance(solved(scene).groups[0]);
  const auto mean = [&](int first, int count) {
    double sum = 0;
    for (int i = first; i < first + count; ++i) sum += double(found[i].x) / count;
    return sum;
  };
  const double f = between_squares();
  EXPECT_NEAR(mean(216, 36), f, 0.02 * f) << "the sheet's front";
  EXPECT_NEAR(mean(252, 16), 0, 1e-3) << "its back";
  // Light is brighter at the middle of the sheet than at its edges, where less of it reaches the wall.
  EXPECT_NEAR(mean(0, 36), kTranslucence * f * f, 0.03 * kTranslucence * f) << "the wall behind";
  EXPECT_EQ(front, 6);
}

INSTANTIATE_TEST_SUITE_P(Methods, Translucence,
                         testing::Combine(testing::Values("matrix", "progressive"),
                                          testing::Values("rays", "hemicube")),
                         [](const auto& test) { return std::get<0>(test.param) + "_" + std::get<1>(test.param); });

}  // namespace
}  // namespace patchlight
