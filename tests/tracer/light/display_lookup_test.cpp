#include "tracer/light/solution/display_lookup.h"

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
    mesh.corners = {6, 0, 7, 1, 0, 3, 1, 4, 7, 1, 8, 2, 1, 4, 2, 5};
    for (int k = 0; k < 4; ++k) {
      mesh.cells[1 + k].face = k;
      mesh.faces.push_back({1, 4 * k, 4, 0.25f});
    }
    for (const float u : {0.75f, 1.0f, 0.5f})
      for (const float v : {0.0f, 0.5f, 1.0f}) mesh.vertices.push_back({1, u, v});
    mesh.gathered = 6;
    energy.groups[0].display = {Color(2.0f), Color(2.0f), Color(2.0f), Color(3.0f), Color(3.0f), Color(3.0f)};
  }

  Color at(float u, float v, float scale = 1.0f) {
    const PatchSet& scene = builder.get();
    const PatchLookup lookup(scene);
    const std::vector<LightMix> mixes{{Color(scale)}};
    const IrradianceLookup patches(
        scene, lookup, SmoothEdges(scene.primitives),
        [&](std::size_t g) { return irradiance_without_sampled(energy.groups[g]); }, mixes);
    const DisplayLookup display(scene, patches, energy, mixes);
    return display(display.blend(0, lookup.patch(0, u, v), u, v), 0, u, v);
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
  std::replace(mesh.corners.begin(), mesh.corners.end(), 1, 9);
  EXPECT_NEAR(floor.at(0.75f, 0.5f).x, 2, 1e-5);
  floor.energy.groups[0].display[3] = Color(5.0f);
  EXPECT_NEAR(floor.at(0.75f, 0.5f).x, 3, 1e-5);
}

TEST(DisplayLookup, PartsOfALeafHaveTheirOwnVertices) {
  Floor floor;
  DisplayMesh& mesh = *floor.energy.display;
  // The lower right leaf is cut at u = 0.9, where both parts have vertices of their own.
  mesh.cells[2] = {-1, -1, 0};
  mesh.cuts = {{{1.8, 0}, {1.8, 1}, {~1, ~4}}};
  const auto first = std::int32_t(mesh.vertices.size());
  for (const float u : {0.9f, 0.9f}) mesh.vertices.insert(mesh.vertices.begin() + 6, {{1, u, 0.0f}, {1, u, 0.5f}});
  for (std::int32_t& corner : mesh.corners) corner += corner >= 6 ? 4 : 0;
  mesh.gathered = 10;
  for (const float value : {4.0f, 4.0f, 7.0f, 7.0f}) floor.energy.groups[0].display.push_back(Color(value));
  mesh.faces[1].first = std::int32_t(mesh.corners.size());
  mesh.corners.insert(mesh.corners.end(), {0, 6, 7, 1});  // 2 to 4
  mesh.faces.push_back({1, std::int32_t(mesh.corners.size()), 4, 0.1f});
  mesh.corners.insert(mesh.corners.end(), {8, 3, 4, 9});  // 7 to 3
  EXPECT_EQ(first, 9);
  EXPECT_NEAR(floor.at(0.825f, 0.25f).x, 3, 1e-5);
  EXPECT_NEAR(floor.at(0.8999f, 0.3f).x, 4, 1e-2);
  EXPECT_NEAR(floor.at(0.9001f, 0.3f).x, 7, 1e-2);
  EXPECT_NEAR(floor.at(0.95f, 0.25f).x, 5, 1e-5);
  EXPECT_NEAR(floor.at(0.75f, 0.25f).x, 2, 1e-5) << "on an edge";
  EXPECT_NEAR(floor.at(0.9f - 1e-7f, 0.0f).x, 4, 1e-4) << "at a corner";
}

}  // namespace
}  // namespace patchlight
