#include "pipeline/formats/patches/patch_clusters.h"

#include <gtest/gtest.h>

#include <limits>

#include "pipeline/formats/describe.h"
#include "tests/pipeline/formats/patch_sample.h"

namespace patchlight {
namespace {

using test::expect_refused;
using test::TemporaryFolder;

/// A floor, a roof of two facets that is two-sided, and a wall.
PatchSet scene_with_clusters() {
  test::PatchScene builder;
  const std::vector<std::array<Vec3d, 4>> roof{{{{0, 1, 0}, {0, 1, 1}, {1, 2, 1}, {1, 2, 0}}},
                                               {{{1, 2, 0}, {1, 2, 1}, {2, 1, 1}, {2, 1, 0}}}};
  std::vector<std::array<Vec3d, 4>> below;
  for (const auto& c : roof) below.push_back({c[1], c[0], c[3], c[2]});
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {2, 0, 1}, {2, 0, 0}}}, 2, 2, {});
  const int top = builder.cluster(roof, {}), bottom = builder.cluster(below, {});
  builder.quad({{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  PatchSet scene = builder.get();
  for (int k = 0; k < 2; ++k) {
    scene.primitives[top + k].back = bottom + k;
    scene.primitives[bottom + k].back = top + k;
  }
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Vec3f normal = point_at(scene.primitives[i], 0.5, 0.5).normal;
    scene.normals.push_back({normal, normal, normal, normal});
    scene.colors.push_back(kWhiteVertices);
    scene.colors.back()[0].x = 0.1f * float(i);
    scene.texcoords.push_back(kIdentityTexcoords);
    scene.texcoords.back()[2].y = float(i);
  }
  return scene;
}

TEST(PatchClustersFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  PatchSet scene = scene_with_clusters();
  const PatchSet before = scene;
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  for (const PatchSet* now : {&std::as_const(scene), &read}) {
    ASSERT_EQ(now->primitives.size(), before.primitives.size());
    ASSERT_EQ(now->patches.size(), before.patches.size());
    for (std::size_t i = 0; i < before.primitives.size(); ++i) {
      EXPECT_EQ(now->primitives[i].corners, before.primitives[i].corners);
      EXPECT_EQ(now->primitives[i].smooth_vertices, before.primitives[i].smooth_vertices);
      EXPECT_EQ(now->primitives[i].back, before.primitives[i].back);
    }
    for (std::size_t i = 0; i < before.patches.size(); ++i) {
      EXPECT_EQ(now->patches[i].primitive, before.patches[i].primitive);
      EXPECT_EQ(now->patches[i].facets, before.patches[i].facets);
    }
    EXPECT_EQ(now->normals, before.normals);
    EXPECT_EQ(now->colors, before.colors);
    EXPECT_EQ(now->texcoords, before.texcoords);
  }
}

TEST(PatchClustersFile, HasOnePrimitiveForACluster) {
  const TemporaryFolder folder;
  PatchSet scene = scene_with_clusters();
  write_patches(folder / "patches.h5", scene);
  const H5Reader reader(folder / "patches.h5", kPatchFormat, kPatchVersion);
  EXPECT_EQ(reader.dataset<std::int32_t>("/primitives/type", -1), (std::vector<std::int32_t>{0, 2, 2, 0}));
  EXPECT_EQ(reader.dataset<std::int32_t>("/patches/primitive", -1), (std::vector<std::int32_t>{0, 0, 0, 0, 1, 2, 3}));
  EXPECT_EQ(reader.dataset<std::int32_t>("/primitives/back", -1), (std::vector<std::int32_t>{-1, 2, 1, -1}));
  EXPECT_EQ(reader.dataset<std::int32_t>("/clusters/facets", -1), (std::vector<std::int32_t>{2, 2}));
  const std::vector<float> uv = reader.dataset<float>("/patches/uv", -1, 4);
  for (std::size_t k = 16; k < 24; ++k) EXPECT_EQ(uv[k], 0) << "of clusters";
  PatchSet other = scene_with_clusters();
  other.primitives[2].corners[2].y = 1.5;
  write_patches(folder / "other.h5", other);
  EXPECT_NE(other.geometry_key, scene.geometry_key);
}

TEST(PatchClustersFile, IsDescribedWithItsClusters) {
  const std::string text = describe(scene_with_clusters());
  EXPECT_NE(text.find("2 are clusters of 4 quads and triangles"), std::string::npos) << text;
}

TEST(PatchClustersFile, RefusesClustersThatAreNone) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  expect_refused(scene_with_clusters(),
                 {{"/primitives/corners", [](PatchSet& s) { s.primitives[2].corners[1].x = kNone; }},
                  {"/patches/uv", [](PatchSet& s) { s.patches[4].u1 = 1; }},
                  {"/primitives", [](PatchSet& s) { s.primitives[1].light_group = 0; }},
                  {"/facets/normals", [](PatchSet& s) { s.normals[2][0] *= 2.0f; }},
                  {"/primitives/color", [](PatchSet& s) { s.colors[2][0].x = 2.0f; }},
                  {"/primitives/smooth_vertices", [](PatchSet& s) { s.primitives[2].smooth_vertices[1] = -1; }}});
}

}  // namespace
}  // namespace patchlight
