#include "importers/import.h"

#include <gtest/gtest.h>

#include <set>

#include "pipeline/formats/patches/patch_check.h"
#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

const Json kSheet{{"name", "sheet"}, {"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}};

TEST(Import, DoubleSidedQuadHasAMirroredBack) {
  Importer importer;
  GltfBuilder gltf = single_mesh(grid(1), kSheet);
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 2u);
  const Primitive& front = scene.primitives[0];
  const Primitive& back = scene.primitives[1];
  EXPECT_EQ(front.back, 1);
  EXPECT_EQ(back.back, 0);
  EXPECT_NEAR((facing(front) + facing(back)).length(), 0.0, 1e-12);
  ASSERT_EQ(scene.patches.size() % 2, 0u);
  const std::size_t half = scene.patches.size() / 2;
  const auto row = static_cast<std::size_t>(std::sqrt(static_cast<double>(half)) + 0.5);
  for (std::size_t i = 0; i < half; ++i) {
    const Patch& here = scene.patches[i];
    const Patch& there = scene.patches[half + i / row * row + (row - 1 - i % row)];
    EXPECT_NEAR((here.center - there.center).length(), 0.0, 1e-6);
    EXPECT_EQ(here.normal, -there.normal);
  }
}

TEST(Import, FrontAndBackShareNoSmoothVertices) {
  Importer importer;
  Mesh bent = grid(2);
  for (Vec3f& p : bent.positions) {
    p.z = p.x == 1.0f ? 0.1f : 0.0f;
    bent.normals.emplace_back(0.0f, 0.0f, 1.0f);
  }
  GltfBuilder gltf = single_mesh(bent, kSheet);
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 8u);
  std::set<int> fronts, backs;
  for (std::size_t i = 0; i < 8; ++i) {
    const auto& ids = scene.primitives[i].smooth_vertices;
    (i % 2 == 0 ? fronts : backs).insert(ids.begin(), ids.end());
  }
  EXPECT_EQ(fronts.size(), 9u);
  EXPECT_EQ(backs.size(), 9u);
  for (const int id : fronts) EXPECT_FALSE(backs.contains(id));
}

TEST(Import, NormalsAreTheFiles) {
  Importer importer;
  Mesh sheet = grid(1);
  for (const Vec3f& p : sheet.positions) sheet.normals.push_back(Vec3f(p.x - 0.5f, 0, 2).normalized());
  GltfBuilder gltf = single_mesh(sheet, kSheet);
  gltf.node({{"mesh", gltf.mesh(grid(1), 0)}, {"translation", {5, 0, 0}}});
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.normals.size(), 4u);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const float side = i == 0 ? 1.0f : -1.0f;
      const Vec3f expected = Vec3f(float(scene.primitives[i].corners[k].x) - 0.5f, 0, 2).normalized() * side;
      EXPECT_NEAR((scene.normals[i][k] - expected).length(), 0.0f, 1e-6f);
    }
  EXPECT_EQ(scene.normals[2], kFlatNormals) << "the file has none";
  GltfBuilder broken = single_mesh(sheet, kSheet);
  broken.json["nodes"][0]["mesh"] = [&] {
    Mesh mesh = sheet;
    mesh.normals[0] = Vec3f(1e30f, 0, 0);
    return broken.mesh(mesh, 0);
  }();
  EXPECT_TRUE(importer.import(broken).normals.empty()) << "one normal is none: flat";
  for (Vec3f& n : sheet.normals) n = {0, 0, -1};
  GltfBuilder wrong = single_mesh(sheet, kSheet);
  EXPECT_TRUE(importer.import(wrong).normals.empty()) << "normals behind the surface say nothing";
}

TEST(Import, NodesShareNoSmoothVertices) {
  Importer importer;
  GltfBuilder gltf;
  const int mesh = gltf.mesh(cube());
  gltf.node({{"mesh", mesh}});
  gltf.node({{"mesh", mesh}});
  std::set<int> ids;
  for (const Primitive& p : importer.import(gltf).primitives)
    ids.insert(p.smooth_vertices.begin(), p.smooth_vertices.end());
  EXPECT_EQ(ids.size(), 48u);
}

TEST(Import, DoubleSidedTriangleAndSphereHaveBacks) {
  Importer importer;
  GltfBuilder gltf = single_mesh(truncated(grid(1), 1), kSheet);
  gltf.node({{"mesh", gltf.mesh(uv_sphere(32, 16), 0)}});  // around the triangle, or it would have one side
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 4u);
  EXPECT_TRUE(scene.primitives[0].is_triangle());
  EXPECT_TRUE(scene.primitives[1].is_triangle());
  EXPECT_NEAR((facing(scene.primitives[0]) + facing(scene.primitives[1])).length(), 0.0, 1e-12);
  EXPECT_NEAR(scene.primitives[2].sphere_radius, 1.0, 1e-6);
  EXPECT_EQ(scene.primitives[3].sphere_radius, -scene.primitives[2].sphere_radius);
  EXPECT_EQ(scene.primitives[3].back, 2);
  EXPECT_EQ(scene.primitives[3].smooth_vertices, (std::array<std::int32_t, 4>{-1, -1, -1, -1}));
}

TEST(Import, MirroredInwardSphereStaysInward) {
  Importer importer;
  GltfBuilder gltf =
      single_mesh(inverted(uv_sphere(32, 16)), nullptr, {{"scale", {-2, 2, 2}}, {"translation", {1, 2, 3}}});
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 1u);
  EXPECT_NEAR(scene.primitives[0].sphere_radius, -2.0, 1e-6);
  EXPECT_NEAR((scene.primitives[0].sphere_center - Vec3d(1, 2, 3)).length(), 0.0, 1e-6);
}

TEST(Import, BoxBecomesSixQuads) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.primitives.size(), 6u);
  EXPECT_NEAR(total_area(scene), 24.0, 1e-10);
}

TEST(Import, MeshPrimitivesOfOneMaterialAreMerged) {
  Importer importer;
  GltfBuilder gltf = single_mesh(truncated(grid(1), 1));
  Mesh other = grid(1);
  other.indices = {0, 3, 2};
  const int second = gltf.mesh(other);
  gltf.json["meshes"][0]["primitives"].push_back(gltf.primitive(second));
  EXPECT_EQ(importer.import(gltf).primitives.size(), 1u);
}

TEST(Import, PatchesOfEveryPrimitiveTypePassThePatchCheck) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), kSheet);
  gltf.node({{"mesh", gltf.mesh(icosphere(1), 0)}, {"translation", {4, 0, 0}}});
  gltf.node({{"mesh", gltf.mesh(icosphere(0))}, {"scale", {1, 2, 0.001}}});
  gltf.node({{"mesh", gltf.mesh(grid(1), gltf.material({{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}}))}});
  for (const double patch_area : {100.0, 0.1, 0.001}) {
    importer.job.import.patch_area = patch_area;
    const PatchSet scene = importer.import(gltf);
    EXPECT_FALSE(static_cast<bool>(find_fault(scene))) << patch_area;
  }
}

TEST(Import, DegenerateTrianglesAreSkippedAndCounted) {
  Importer importer;
  Mesh mesh = cube();
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 2, 2, 2, 3, 4, 3});
  GltfBuilder gltf = single_mesh(mesh);
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("3 triangles without area"));
}

TEST(Import, SceneWithoutSurfacesIsRefused) {
  Importer importer;
  GltfBuilder flat = single_mesh(cube(), nullptr, {{"scale", {1, 0, 0}}});
  EXPECT_ERROR(importer.import(flat), ExitCode::bad_data, "no surface with an area");
  GltfBuilder empty;
  empty.node(Json::object());
  EXPECT_ERROR(importer.import(empty), ExitCode::bad_data, "no surface with an area");
}

TEST(Import, TooManyPatchesNameTheLimit) {
  Importer importer;
  importer.job.import.patch_area = 1e-12;
  GltfBuilder gltf = single_mesh(cube());
  EXPECT_ERROR(importer.import(gltf), ExitCode::over_limit, "import.max_patches");
}

TEST(Import, PartsOfCutPatchesCountForTheLimit) {
  Importer importer;
  importer.job.import.patch_area = 0.05;
  GltfBuilder gltf;
  const int mesh = gltf.mesh(cube());
  gltf.node({{"mesh", mesh}});
  gltf.node({{"mesh", mesh}, {"translation", {0.31, 0.27, 0.23}}});
  const PatchSet scene = importer.import(gltf);
  ASSERT_FALSE(scene.cuts.empty());
  importer.job.import.max_patches = std::int64_t(scene.patches.size());
  EXPECT_EQ(importer.import(gltf).patches.size(), scene.patches.size());
  --importer.job.import.max_patches;
  EXPECT_ERROR(importer.import(gltf), ExitCode::over_limit, "parts that other surfaces cut off");
}

TEST(Import, SameFileGivesTheSamePatches) {
  Importer importer;
  GltfBuilder gltf = single_mesh(icosphere(0));
  const PatchSet first = importer.import(gltf);
  const PatchSet second = importer.import(gltf);
  ASSERT_EQ(first.patches.size(), second.patches.size());
  for (std::size_t i = 0; i < first.patches.size(); ++i) {
    EXPECT_EQ(first.patches[i].center, second.patches[i].center);
    EXPECT_EQ(first.patches[i].area, second.patches[i].area);
  }
  EXPECT_EQ(first.inputs_key, second.inputs_key);
}

TEST(Import, ScaledSceneHasTheSameStructure) {
  std::vector<std::size_t> counts;
  for (const double scale : {1e-3, 1.0, 1e3}) {
    Importer importer;
    GltfBuilder gltf = single_mesh(cube(), nullptr, {{"scale", {scale, scale, scale}}, {"translation", {1e4, 0, 0}}});
    counts.push_back(importer.import(gltf).patches.size());
  }
  EXPECT_EQ(counts[0], counts[1]);
  EXPECT_EQ(counts[1], counts[2]);
}

}  // namespace
}  // namespace patchlight::test
