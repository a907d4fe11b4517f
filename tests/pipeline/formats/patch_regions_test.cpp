#include "pipeline/formats/patches/patch_regions.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/pipeline/formats/patch_sample.h"

namespace patchlight {
namespace {

using test::expect_refused;
using test::TemporaryFolder;

/// A rectangle of 2 x 2 cells of 1 m2 each, of which one is empty, and one is a triangle.
PatchSet region_scene() {
  test::PatchScene builder;
  builder.quad({{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}}, 2, 2, {});
  PatchSet scene = builder.get();
  Region region;
  region.pieces = {{{{0, 0}, {1, 0}, {1, 0.5}, {0, 0.5}}}, {{{0.5, 0.5}, {1, 0.5}, {1, 1}, {1, 1}}}};
  region.edges = {
      {{{0, 0}, {1, 0}}}, {{{1, 0}, {1, 1}}}, {{{1, 1}, {0.5, 0.5}}}, {{{0.5, 0.5}, {0, 0.5}}}, {{{0, 0.5}, {0, 0}}}};
  scene.primitives[0].region = std::make_shared<const Region>(region);
  scene.patches.erase(scene.patches.begin() + 2);
  scene.patches[2].area = 0.5;
  return scene;
}

/// Replaces the scene's region by one that `change` makes of it.
void change_region(PatchSet& scene, const std::function<void(Region&)>& change) {
  Region region = *scene.primitives[0].region;
  change(region);
  scene.primitives[0].region = std::make_shared<const Region>(std::move(region));
}

TEST(PatchRegionsFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  PatchSet scene = region_scene();
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  ASSERT_TRUE(read.primitives[0].region);
  EXPECT_EQ(*read.primitives[0].region, *scene.primitives[0].region);
  EXPECT_TRUE(read.patches[0].triangles.empty()) << "a whole cell";
  EXPECT_EQ(read.patches[2].triangles.size(), 3u);
  PatchSet other = region_scene();
  change_region(other, [](Region& region) { region.edges.pop_back(); });
  write_patches(folder / "other.h5", other);
  EXPECT_NE(other.geometry_key, scene.geometry_key);
}

TEST(PatchRegionsFile, RefusesRegionsThatAreNone) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto with_region = [](const std::function<void(Region&)>& change) {
    return [change](PatchSet& scene) { change_region(scene, change); };
  };
  expect_refused(region_scene(),
                 {
                     {"/regions/piece", with_region([&](Region& r) { r.pieces[0][1].x = kNone; })},
                     {"/regions/piece", with_region([](Region& r) { r.pieces[0][2].y = 1.5; })},
                     {"/regions/piece", with_region([](Region& r) { std::swap(r.pieces[0][1], r.pieces[0][3]); })},
                     {"/regions/piece", with_region([](Region& r) {
                        r.pieces[0][2] = {0.1, 0.1};
                      })},
                     {"/regions/edge", with_region([](Region& r) { r.edges[0][0].x = -1; })},
                     {"/regions/counts", with_region([](Region& r) { r.pieces.clear(); })},
                     {"/primitives/corners", [](PatchSet& s) { s.primitives[0].corners[2].x = 1.5; }},
                     {"/patches/area", [](PatchSet& s) { s.patches[2].area = 0.6; }},
                     {"/patches/area",
                      [](PatchSet& s) {
                        s.patches[2].u0 = 0;
                        s.patches[2].u1 = 0.5f;
                      }},
                     {"/patches/uv", [](PatchSet& s) { s.patches[2].u0 = 0.6f; }},
                     {"/patches/uv", [](PatchSet& s) { s.patches[0].u1 = std::numeric_limits<float>::infinity(); }},
                     {"/patches/uv", [](PatchSet& s) { s.patches[0].u1 = 0; }},
                     {"/patches/uv", [](PatchSet& s) { std::swap(s.patches[0], s.patches[1]); }},
                 });
}

}  // namespace
}  // namespace patchlight
