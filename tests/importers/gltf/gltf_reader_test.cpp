#include "importers/gltf/read/gltf_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// Whether all quads face away from a point.
bool faces_away_from(const PatchSet& scene, const Vec3d& center) {
  return std::all_of(scene.primitives.begin(), scene.primitives.end(), [&](const Primitive& p) {
    return facing(p).dot((p.corners[0] + p.corners[2]) * 0.5 - center) > 0.0;
  });
}

TEST(GltfReader, TransformsChainAndScaleUnevenly) {
  Importer importer;
  GltfBuilder gltf;
  gltf.json["nodes"] = {
      {{"translation", {10, 0, 0}}, {"scale", {2, 1, 1}}, {"children", {1}}},
      {{"mesh", gltf.mesh(cube())}, {"rotation", {0, 0, 0.70710678, 0.70710678}}, {"scale", {1, 2, 3}}}};
  gltf.json["scenes"] = {{{"nodes", {0}}}};
  const PatchSet scene = importer.import(gltf);
  Imath::V3d low(1e9), high(-1e9);
  for (const Primitive& p : scene.primitives) {
    for (const Vec3d& c : p.corners) {
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], c[i]), high[i] = std::max(high[i], c[i]);
    }
  }
  // The rotation by 90 degrees about Z maps the child's Y, scaled by 2, to X, which the parent scales by 2.
  EXPECT_NEAR((low - Vec3d(6, -1, -3)).length(), 0.0, 1e-6);
  EXPECT_NEAR((high - Vec3d(14, 1, 3)).length(), 0.0, 1e-6);
  EXPECT_TRUE(faces_away_from(scene, {10, 0, 0}));
}

TEST(GltfReader, MirroredNodesStillFaceOut) {
  for (const std::vector<int>& scale : {std::vector{-1, 1, 1}, {1, -2, 1}, {-1, -1, -1}, {-1, 1, -1}}) {
    Importer importer;
    GltfBuilder gltf = single_mesh(cube(), nullptr, {{"scale", scale}});
    EXPECT_TRUE(faces_away_from(importer.import(gltf), Vec3d(0.0)));
  }
}

TEST(GltfReader, MatrixIsColumnMajor) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), nullptr, {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}});
  EXPECT_TRUE(faces_away_from(importer.import(gltf), {5, 6, 7}));
}

TEST(GltfReader, ProjectiveMatrixIsRefused) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), nullptr, {{"matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}});
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "affine");
}

TEST(GltfReader, HiddenNodesAreLeftOutWithAllBelowThem) {
  Importer importer;
  GltfBuilder gltf;
  const int mesh = gltf.mesh(cube());
  const Json light = {{"KHR_lights_punctual", {{"light", 0}}}};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  const auto hidden = [](const Json& visible) { return Json{{"KHR_node_visibility", {{"visible", visible}}}}; };
  gltf.json["nodes"] = {{{"children", {1, 2}}, {"extensions", hidden(false)}},
                        {{"mesh", mesh}, {"extensions", hidden(true)}},
                        {{"extensions", light}},
                        {{"mesh", mesh}, {"translation", {5, 0, 0}}, {"extensions", hidden(true)}},
                        {{"extensions", light}}};
  gltf.json["scenes"] = {{{"nodes", {0, 3, 4}}}};
  gltf.json["extensionsRequired"] = {"KHR_node_visibility"};
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.primitives.size(), 6u);
  EXPECT_EQ(scene.lights.size(), 1u);
  EXPECT_GT(scene.primitives[0].corners[0].x, 3);

  gltf.json["nodes"][0]["extensions"] = hidden("no");
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "must be true or false");
}

TEST(GltfReader, SharedMeshIsImportedOncePerNode) {
  Importer importer;
  GltfBuilder gltf;
  const int mesh = gltf.mesh(cube());
  gltf.node({{"mesh", mesh}, {"name", "left"}});
  gltf.node({{"mesh", mesh}, {"translation", {5, 0, 0}}});
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.primitives.size(), 12u);
  EXPECT_EQ(scene.nodes, (std::vector<std::string>{"left", "node_1"}));
  EXPECT_EQ(scene.primitives[0].node, 0);
  EXPECT_EQ(scene.primitives[11].node, 1);
}

TEST(GltfReader, OnlyTheDefaultSceneIsRead) {
  Importer importer;
  GltfBuilder gltf;
  const int mesh = gltf.mesh(cube());
  gltf.json["nodes"] = {{{"mesh", mesh}}, {{"mesh", mesh}}};
  gltf.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {0, 1}}}};
  gltf.json["scene"] = 1;
  EXPECT_EQ(importer.import(gltf).primitives.size(), 12u);
  gltf.json["scene"] = 0;
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
}

TEST(GltfReader, WithoutASceneAllRootNodesAreRead) {
  Importer importer;
  GltfBuilder gltf;
  const int mesh = gltf.mesh(cube());
  gltf.json["nodes"] = {
      {{"mesh", mesh}, {"children", {1}}}, {{"mesh", mesh}, {"translation", {9, 0, 0}}}, {{"mesh", mesh}}};
  gltf.json.erase("scene");
  EXPECT_EQ(importer.import(gltf).primitives.size(), 18u);
}

TEST(GltfReader, StripsAndFansHaveTheWindingOfTheirFirstTriangle) {
  const std::vector<Vec3f> strip{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {1, 2, 0}};
  const std::vector<Vec3f> fan{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const auto& [mode, positions, area] : {std::tuple(5, strip, 2.0), std::tuple(6, fan, 1.0)}) {
    for (const int x_scale : {1, -1}) {
      Importer importer;
      GltfBuilder gltf = single_mesh({positions, {}, {}}, nullptr, {{"scale", {x_scale, 1, 1}}});
      gltf.primitive(0)["mode"] = mode;
      const PatchSet scene = importer.import(gltf);
      EXPECT_NEAR(total_area(scene), area, 1e-12);
      for (const Primitive& p : scene.primitives) EXPECT_NEAR(facing(p).z, 1.0, 1e-12);
    }
  }
}

TEST(GltfReader, SmallIndexTypesAreRead) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  const std::vector<std::uint32_t> wide = cube().indices;
  gltf.primitive(0)["indices"] = gltf.accessor(std::vector<std::uint8_t>(wide.begin(), wide.end()), 5121, "SCALAR");
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
  gltf.json.erase("buffers");
  gltf.primitive(0)["indices"] = gltf.accessor(std::vector<std::uint16_t>(wide.begin(), wide.end()), 5123, "SCALAR");
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
}

TEST(GltfReader, LinesAreSkippedWithAWarning) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  const int lines = gltf.mesh(cube());
  gltf.primitive(lines)["mode"] = 1;
  gltf.node({{"mesh", lines}});
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("points and lines"));
}

TEST(GltfReader, IndexBeyondTheVerticesNamesTheNode) {
  Importer importer;
  Mesh mesh = cube();
  mesh.indices[5] = 8;
  GltfBuilder gltf = single_mesh(mesh, nullptr, {{"name", "crate"}});
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "crate");
}

TEST(GltfReader, NonFinitePositionsNameTheNode) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Importer importer;
    Mesh mesh = cube();
    mesh.positions[3].y = bad;
    GltfBuilder gltf = single_mesh(mesh, nullptr, {{"name", "crate"}});
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "crate");
  }
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), nullptr, {{"name", "crate"}, {"scale", {1e300, 1, 1}}});
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "crate");
}

TEST(GltfReader, TooManyTrianglesAreRefusedBeforeTheyAreRead) {
  Importer importer;
  importer.job.import.max_patches = 1000;
  GltfBuilder gltf;
  const int mesh = gltf.mesh(grid(50));
  for (int i = 0; i < 100; ++i) gltf.node({{"mesh", mesh}});
  EXPECT_ERROR(importer.import(gltf), ExitCode::over_limit, "import.max_patches");
}

Json perspective() {
  return {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.5}, {"znear", 0.1}}}};
}

TEST(GltfReader, CamerasKeepDirectionWithoutScale) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  gltf.json["cameras"] = {
      perspective(),
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0}, {"zfar", 9}}}}};
  gltf.node({{"camera", 0}, {"name", "Eye"}, {"scale", {2, 3, 4}}, {"translation", {1, 2, 3}}});
  gltf.node({{"camera", 1}, {"rotation", {0, 1, 0, 0}}, {"scale", {-1, 1, 1}}});
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "Eye");
  EXPECT_DOUBLE_EQ(scene.cameras[0].vertical, 0.5);
  EXPECT_DOUBLE_EQ(scene.cameras[0].aspect, 1.5);
  Matrix4 expected;
  expected.setTranslation(Vec3d(1, 2, 3));
  EXPECT_TRUE(scene.cameras[0].to_world.equalWithAbsError(expected, 1e-12));
  EXPECT_EQ(scene.cameras[1].name, "node_2");
  EXPECT_EQ(scene.cameras[1].projection, Camera::Projection::orthographic);
  EXPECT_DOUBLE_EQ(scene.cameras[1].vertical, 2.0);
  EXPECT_NEAR(scene.cameras[1].to_world[2][2], -1.0, 1e-12);
  EXPECT_NEAR(scene.cameras[1].to_world.determinant(), 1.0, 1e-12);
}

/// The only camera of a scene.
Camera imported_camera(const Json& camera, const Json& extras, Importer& importer) {
  GltfBuilder gltf = single_mesh(cube());
  gltf.json["cameras"] = {camera};
  gltf.node({{"camera", 0}, {"name", "Eye"}, {"extras", extras}});
  return importer.import(gltf).cameras.at(0);
}

TEST(GltfReader, CamerasHaveTheClipDepthsOfTheFileAndTheLensOfTheirExtras) {
  Importer importer;
  Camera camera = imported_camera(perspective(), Json::object(), importer);
  EXPECT_EQ(camera.znear, 0.1);
  EXPECT_TRUE(std::isinf(camera.zfar));
  EXPECT_EQ(camera.shift, Vec2d(0.0));
  EXPECT_FALSE(camera.has_lens());
  Json finite = perspective();
  finite["perspective"]["zfar"] = 25;
  const Json extras = {{"shift", {0.25, -1}}, {"aspect", 2}, {"aperture", 0.02}, {"focus", 3}, {"light_group", "a"}};
  camera = imported_camera(finite, extras, importer);
  EXPECT_EQ(camera.zfar, 25);
  EXPECT_EQ(camera.shift, Vec2d(0.25, -1));
  EXPECT_EQ(camera.aspect, 2);
  EXPECT_EQ(camera.aperture, 0.02);
  EXPECT_EQ(camera.focus, 3);
  finite["perspective"]["znear"] = 30;
  EXPECT_EQ(imported_camera(finite, extras, importer).znear, 0);
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("camera 'Eye': znear 30 and zfar 25"));
}

TEST(GltfReader, ExtrasOfCamerasThatCannotBeAreRefusedByNode) {
  Importer importer;
  for (const auto& [key, value] : {std::pair<const char*, Json>("shift", 1),
                                   {"shift", {1, 2, 3}},
                                   {"shift", {0, "a"}},
                                   {"shift", {1e9, 0}},
                                   {"aspect", 0},
                                   {"aspect", "wide"},
                                   {"aperture", -1},
                                   {"aperture", 0.1},
                                   {"focus", 0},
                                   {"focus", nullptr}})
    EXPECT_ERROR(imported_camera(perspective(), {{key, value}}, importer), ExitCode::bad_data,
                 std::string("nodes[1] 'Eye'.extras.") + key);
}

TEST(GltfReader, InvalidCamerasAreSkippedWithAWarning) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  gltf.json["cameras"] = {perspective(), {{"type", "fisheye"}}, {{"type", "perspective"}}};
  gltf.json["cameras"][0]["perspective"]["yfov"] = -1;
  for (int i = 0; i < 3; ++i) gltf.node({{"camera", i}, {"name", "blind"}});
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].name, "default");
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("blind"));
}

TEST(GltfReader, SceneWithoutCamerasGetsOneThatFramesIt) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), nullptr, {{"translation", {100, 0, 0}}});
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Camera& camera = scene.cameras[0];
  EXPECT_EQ(camera.name, "default");
  const Matrix4 to_camera = camera.to_world.inverse();
  for (const Primitive& p : scene.primitives) {
    for (const Vec3d& corner : p.corners) {
      const Vec3d seen = corner * to_camera;
      EXPECT_LT(seen.z, 0.0);
      EXPECT_LT(std::abs(seen.y) / -seen.z, std::tan(camera.vertical / 2));
      EXPECT_LT(std::abs(seen.x) / -seen.z, std::tan(camera.vertical / 2));
    }
  }
}

}  // namespace
}  // namespace patchlight::test
