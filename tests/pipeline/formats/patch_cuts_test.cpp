#include "pipeline/formats/patches/patch_cuts.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/pipeline/formats/patch_sample.h"

namespace patchlight {
namespace {

using test::expect_refused;
using test::TemporaryFolder;

/// Two cells of 1 m2, of which the second is cut into three parts.
PatchSet cut_scene() {
  test::PatchScene builder;
  builder.quad({{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}}, 2, 1, {});
  PatchSet scene = builder.get();
  for (int k = 0; k < 2; ++k) scene.patches.push_back(scene.patches[1]);
  scene.cuts = {{{1.5, 0}, {1.5, 1}, {~1, 1}}, {{1, 0.5}, {2, 0.5}, {~2, ~3}}};
  const double areas[]{1, 0.5, 0.25, 0.25};
  for (std::size_t i = 0; i < 4; ++i) {
    scene.patches[i].area = areas[i];
    scene.patches[i].cut = i > 0 ? 0 : -1;
  }
  scene.patches[0].closed = 2;
  return scene;
}

TEST(PatchCutsFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  PatchSet scene = cut_scene();
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  ASSERT_EQ(read.cuts.size(), 2u);
  EXPECT_EQ(read.cuts[1].from, scene.cuts[1].from);
  EXPECT_EQ(read.cuts[0].sides, scene.cuts[0].sides);
  EXPECT_EQ(read.patches[0].closed, 2);
  EXPECT_EQ(read.patches[3].cut, 0);
  EXPECT_TRUE(read.patches[0].triangles.empty());
  EXPECT_EQ(read.patches[1].triangles.size(), 6u);
  for (const Vec3d& corner : read.patches[1].triangles) EXPECT_LE(corner.x, 1.5) << "to the left of a line upwards";
  PatchSet uncut = cut_scene();
  uncut.cuts[1].to.y = 0.6;
  uncut.patches[2].area = 0.225;
  uncut.patches[3].area = 0.275;
  write_patches(folder / "other.h5", uncut);
  EXPECT_NE(uncut.geometry_key, scene.geometry_key);
}

TEST(PatchCutsFile, RefusesCutsThatAreNone) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  expect_refused(cut_scene(), {
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts[0].sides[1] = 0; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts[0].sides[1] = 2; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts[0].sides[1] = ~2; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts[1].sides[1] = ~4; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts[1].sides[1] = ~2; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts[1].sides[1] = ~0; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts[1].sides[1] = INT32_MIN; }},
                                  {"/cuts/line", [](PatchSet& s) { s.cuts[0].to = s.cuts[0].from; }},
                                  {"/cuts/line", [](PatchSet& s) { s.cuts[0].to.x = kNone; }},
                                  {"/patches/area", [](PatchSet& s) { s.cuts[0].from.x = s.cuts[0].to.x = 5; }},
                                  {"/patches/uv", [](PatchSet& s) { s.patches[3].cut = -1; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.patches[3].cut = 1; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.patches[3].cut = 2; }},
                                  {"/patches/uv", [](PatchSet& s) { s.patches[3].cut = -2; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.patches[3].u1 = 0.75f; }},
                                  {"/patches/area", [](PatchSet& s) { s.patches[3].area = 0.5; }},
                                  {"/cuts/sides", [](PatchSet& s) { s.patches.pop_back(); }},
                                  {"/cuts/sides", [](PatchSet& s) { s.cuts.pop_back(); }},
                                  {"/patches/cut", [](PatchSet& s) { s.primitives[0].corners[2].z = 0.1; }},
                                  {"/patches/closed", [](PatchSet& s) { s.patches[0].closed = 16; }},
                              });
}

}  // namespace
}  // namespace patchlight
