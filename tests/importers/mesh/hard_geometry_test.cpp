// Defects that occur in real meshes, and how the importer treats them.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

PatchSet imported(const Mesh& mesh) {
  Importer importer;
  GltfBuilder gltf = single_mesh(mesh);
  return importer.import(gltf);
}

void append_quad(Mesh& mesh, const std::array<Vec3f, 4>& corners) {
  const auto first = std::uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + k);
}

TEST(HardGeometry, DegenerateFacesAreSkipped) {
  Mesh mesh = grid(3);
  mesh.indices.insert(mesh.indices.end(), {0, 1, 2, 5, 5, 6, 0, 0, 0});
  const PatchSet scene = imported(mesh);
  EXPECT_EQ(scene.primitives.size(), 1u);
  EXPECT_NEAR(total_area(scene), 9.0, 1e-9);
}

TEST(HardGeometry, NonManifoldEdgesSplitTheSurface) {
  Mesh mesh = grid(4);  // with a wall along its middle, from edge to edge
  const std::vector<Vec3f> floor = mesh.positions;
  for (std::uint32_t y = 0; y < 4; ++y)
    append_quad(mesh, {floor[5 * y + 2], floor[5 * y + 7], floor[5 * y + 7] + Vec3f(0, 0, 1),
                       floor[5 * y + 2] + Vec3f(0, 0, 1)});
  const PatchSet scene = imported(mesh);
  EXPECT_EQ(scene.primitives.size(), 3u) << "two halves of the floor and the wall";
  EXPECT_NEAR(total_area(scene), 20.0, 1e-9);
}

TEST(HardGeometry, DuplicateFacesAreBothKept) {
  Mesh mesh = grid(4);
  mesh.indices.insert(mesh.indices.end(), mesh.indices.begin(), mesh.indices.begin() + 6);
  const PatchSet scene = imported(mesh);
  EXPECT_NEAR(total_area(scene), 17.0, 1e-9);
  EXPECT_LE(scene.primitives.size(), 6u);
}

TEST(HardGeometry, FlippedFacesStayFlipped) {
  Mesh mesh = grid(3);
  std::swap(mesh.indices[25], mesh.indices[26]);  // both triangles of the cell in the middle
  std::swap(mesh.indices[28], mesh.indices[29]);
  const PatchSet scene = imported(mesh);
  ASSERT_EQ(scene.primitives.size(), 5u) << "four around the one in the middle";
  EXPECT_EQ(std::count_if(scene.primitives.begin(), scene.primitives.end(),
                          [](const Primitive& p) { return facing(p).z < 0; }),
            1);
  EXPECT_NEAR(total_area(scene), 9.0, 1e-9);
}

TEST(HardGeometry, NGonsKeepTheirAreaWithFewerFacets) {
  for (const int n : {5, 6, 12, 100}) {
    Mesh gon;
    for (int i = 0; i < n; ++i)
      gon.positions.emplace_back(Vec3d(std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n), 0));
    for (std::uint32_t i = 1; i + 1 < std::uint32_t(n); ++i) gon.indices.insert(gon.indices.end(), {0, i, i + 1});
    const PatchSet scene = imported(gon);
    EXPECT_LE(scene.primitives.size(), std::size_t(n) / 2);
    EXPECT_NEAR(total_area(scene), 0.5 * n * std::sin(2 * kPi / n), 1e-6);
  }
}

TEST(HardGeometry, NonPlanarFacesKeepTheirTriangles) {
  const PatchSet scene = imported(quad_mesh({{{0, 0, 0}, {1, 0, 0.1f}, {1, 1, 0}, {0, 1, 0.1f}}}));
  ASSERT_EQ(scene.primitives.size(), 2u);
  EXPECT_TRUE(scene.primitives[0].is_triangle() && scene.primitives[1].is_triangle());
}

TEST(HardGeometry, HugeAndTinyMeshesInOneScene) {
  Importer importer;
  GltfBuilder gltf;
  gltf.node({{"name", "ground"}, {"mesh", gltf.mesh(scaled(grid(4), Vec3f(2.5e4f)))}});
  gltf.node({{"name", "grain"}, {"mesh", gltf.mesh(scaled(cube(), Vec3f(0.5e-4f)))}, {"translation", {1, 1, 1}}});
  const PatchSet scene = importer.import(gltf);
  const auto is_grain = [&](const Primitive& p) { return scene.nodes[p.node] == "grain"; };
  EXPECT_EQ(std::count_if(scene.primitives.begin(), scene.primitives.end(), is_grain), 6);
  double grain = 0.0;
  for (const Patch& patch : scene.patches)
    if (is_grain(scene.primitives[patch.primitive])) grain += patch.area;
  EXPECT_NEAR(grain / 6e-8, 1.0, 1e-6);
  EXPECT_NEAR(total_area(scene) / 1e10, 1.0, 1e-6);
}

TEST(HardGeometry, RegionsThatTouchThemselvesInAVertexKeepTheirArea) {
  Mesh mesh = grid(4);  // without the two cells that meet in the middle
  const auto cell = [&](std::size_t x, std::size_t y) {
    return mesh.indices.begin() + std::ptrdiff_t(6 * (4 * y + x));
  };
  mesh.indices.erase(cell(2, 2), cell(2, 2) + 6);
  mesh.indices.erase(cell(1, 1), cell(1, 1) + 6);
  const PatchSet scene = imported(mesh);
  EXPECT_NEAR(total_area(scene), 14.0, 1e-9);
}

}  // namespace
}  // namespace patchlight::test
