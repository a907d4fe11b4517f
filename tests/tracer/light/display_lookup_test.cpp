#include "tracer/light/display_lookup.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// A floor of two patches, the second subdivided into four leaves. Irradiance is 1 on patches and that of `display` at
/// the gathered vertices.
struct Floor {
  PatchScene builder;
  EnergyField energy;

  Floor() {
    builder.quad({{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}}, 2, 1, {});
    energy.groups = {{"light", {Color(9.0f), Color(9.0f)}, {Color(1.0f), Color(1.0f)}}};
    DisplayMesh& mesh = energy.display.emplace();
    mesh.roots = {-1, 0};
    mesh.cells.resize(5);
    mesh.cells[0].children = 1;
    // Vertices of the middle and the right column are gathered; those of the left one lie on the border.
    mesh.cells[1] = {-1, 0, false, {6, 0, 7, 1}};
    mesh.cells[2] = {-1, 1, false, {0, 3, 1, 4}};
    mesh.cells[3] = {-1, 2, false, {7, 1, 8, 2}};
    mesh.cells[4] = {-1, 3, false, {1, 4, 2, 5}};
    mesh.elements = 4;
    for (const float u : {0.75f, 1.0f, 0.5f})
      for (const float v : {0.0f, 0.5f, 1.0f}) mesh.vertices.push_back({1, u, v});
    mesh.gathered = 6;
    energy.groups[0].display = {Color(2.0f), Color(2.0f), Color(2.0f), Color(3.0f), Color(3.0f), Color(3.0f)};
  }

  Color at(float u, float v, float scale = 1.0f) {
    const PatchSet& scene = builder.get();
    const RayScene ray_scene(scene);
    const PatchLookup lookup(scene);
    const std::vector<LightMix> mixes{{Color(scale)}};
    const IrradianceLookup patches(
        scene, lookup, [&](std::size_t g) { return irradiance_without_sampled(energy.groups[g]); }, mixes);
    DisplayLookup::CornerCache cache;
    const DisplayLookup display(scene, ray_scene, patches, energy, mixes);
    return display(display.blend(0, lookup.patch(0, u, v), u, v, cache), 0, u, v);
  }
};

TEST(DisplayLookup, IsBilinearInLeavesAndContinuousTowardsPatches) {
  Floor floor;
  EXPECT_NEAR(floor.at(0.2f, 0.3f).x, 1, 1e-6);
  EXPECT_NEAR(floor.at(0.5f, 0.3f).x, 1, 1e-6);
  EXPECT_NEAR(floor.at(0.625f, 0.3f).x, 1.5, 1e-5);
  EXPECT_NEAR(floor.at(0.75f, 0.9f).x, 2, 1e-5);
  EXPECT_NEAR(floor.at(1.0f, 0.9f).x, 3, 1e-5);
}

TEST(DisplayLookup, IsBilinearOnFacetsBetweenVerticesAndPatchValues) {
  Floor floor;
  floor.energy.display->facets = {{0, {0, 3, -1, -1}}};
  EXPECT_NEAR(floor.at(0.0f, 0.0f).x, 2, 1e-5);
  EXPECT_NEAR(floor.at(0.4f, 0.0f).x, 2.4, 1e-5);
  EXPECT_NEAR(floor.at(0.0f, 1.0f).x, 1, 1e-5);
  EXPECT_NEAR(floor.at(0.4f, 0.5f).x, 1.7, 1e-5);
}

TEST(DisplayLookup, FollowsTheSettingsOfTheLights) {
  Floor floor;
  EXPECT_NEAR(floor.at(0.625f, 0.3f, 2.0f).x, 3, 1e-5);
  EXPECT_EQ(floor.at(0.9f, 0.3f, 0.0f).x, 0);
}

TEST(DisplayLookup, MidpointsAreTheMeanOfTheirEnds) {
  Floor floor;
  DisplayMesh& mesh = *floor.energy.display;
  mesh.vertices.push_back({1, 0.75f, 0.5f});
  mesh.midpoints = {{3, 8}};  // between vertex 3 and one on the border, which is 1
  for (auto& cell : mesh.cells) std::replace(cell.corners.begin(), cell.corners.end(), 1, 9);
  EXPECT_NEAR(floor.at(0.75f, 0.5f).x, 2, 1e-5);
  floor.energy.groups[0].display[3] = Color(5.0f);
  EXPECT_NEAR(floor.at(0.75f, 0.5f).x, 3, 1e-5);
}

TEST(DisplayLookup, LeavesOutHiddenCorners) {
  Floor floor;
  floor.builder.quad({{{1.8, -1, -1}, {1.8, 2, -1}, {1.8, 2, 1}, {1.8, -1, 1}}}, 1, 1, {});
  floor.energy.groups[0].direct.emplace_back(0.0f);
  floor.energy.groups[0].indirect.emplace_back(0.0f);
  floor.energy.display->roots.push_back(-1);
  EXPECT_NEAR(floor.at(0.85f, 0.3f).x, 2.4, 1e-5);
  for (auto& cell : floor.energy.display->cells) cell.cut = cell.children < 0;
  EXPECT_NEAR(floor.at(0.85f, 0.3f).x, 2, 1e-5) << "in front of the wall";
  EXPECT_NEAR(floor.at(0.95f, 0.3f).x, 3, 1e-5) << "behind it";
}

}  // namespace
}  // namespace patchlight
