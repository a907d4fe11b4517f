#include "importers/mesh/mesh_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/importers/mesh/mesh_shapes.h"

namespace patchlight::test {
namespace {

std::set<int> smooth_ids(const MeshTopology& topology) {
  std::set<int> ids;
  for (const auto& triangle : topology.triangles)
    ids.insert(triangle.smooth_vertices.begin(), triangle.smooth_vertices.end());
  return ids;
}

/// The mesh with the normals of the unit sphere.
Mesh with_round_normals(Mesh mesh) {
  mesh.normals = mesh.positions;
  return mesh;
}

TEST(MeshTopology, WeldsSplitVerticesIntoAClosedSurface) {
  TriangleSoup soup = soup_of(cube());
  const MeshTopology topology = build_topology(soup);
  EXPECT_EQ(topology.vertices.size(), 8u);
  ASSERT_EQ(topology.components.size(), 1u);
  EXPECT_TRUE(topology.components[0].closed);
}

TEST(MeshTopology, NegativeZeroIsZero) {
  TriangleSoup soup = soup_of(cube());
  for (Vec3d& p : soup.positions) p -= Vec3d(1.0);
  for (std::size_t i = 0; i < soup.positions.size(); i += 2)
    for (int axis = 0; axis < 3; ++axis)
      if (soup.positions[i][axis] == 0.0) soup.positions[i][axis] = -0.0;
  EXPECT_EQ(build_topology(soup).vertices.size(), 8u);
}

TEST(MeshTopology, CubeHasACreaseAtEveryEdge) {
  EXPECT_EQ(smooth_ids(build_topology(soup_of(cube()))).size(), 24u);
}

TEST(MeshTopology, FlatGridHasNoCreases) {
  EXPECT_EQ(smooth_ids(build_topology(soup_of(grid(4)))).size(), 25u);
}

TEST(MeshTopology, NormalsOfTheFileMakeASphereSmooth) {
  const Mesh sphere = with_round_normals(icosphere(2));
  EXPECT_EQ(smooth_ids(build_topology(soup_of(sphere))).size(), sphere.positions.size());
}

TEST(MeshTopology, WithoutNormalsEveryEdgeOfASphereIsACrease) {
  const Mesh sphere = icosphere(2);
  EXPECT_EQ(smooth_ids(build_topology(soup_of(sphere))).size(), sphere.indices.size());
}

TEST(MeshTopology, SharpEdgeIsACreaseDespiteSmoothNormals) {
  EXPECT_EQ(smooth_ids(build_topology(soup_of(with_round_normals(cube())))).size(), 24u);
}

TEST(MeshTopology, NormalsBehindTheirTrianglesAreCountedAndOmitted) {
  Mesh mesh = grid(1);
  mesh.normals.assign(mesh.positions.size(), Vec3f(0, 0, 1));
  EXPECT_EQ(build_topology(soup_of(mesh)).normals_behind, 0u);
  mesh.normals[mesh.indices[1]] = Vec3f(0, 0, -1);
  const MeshTopology topology = build_topology(soup_of(mesh));
  EXPECT_GT(topology.normals_behind, 0u);
  const auto omitted = std::size_t(std::count(topology.normals.begin(), topology.normals.end(), Vec3f(0.0f)));
  EXPECT_EQ(omitted, 3 * topology.normals_behind) << "all of a triangle's";
}

TEST(MeshTopology, DegenerateTrianglesAreCountedAndSkipped) {
  Mesh mesh = cube();
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 5, 5, 5});
  const MeshTopology topology = build_topology(soup_of(mesh));
  EXPECT_EQ(topology.degenerate_triangles, 2u);
  EXPECT_EQ(topology.triangles.size(), 12u);
}

TEST(MeshTopology, ThinTriangleIsNotDegenerate) {
  const Mesh sliver{{{0, 0, 0}, {1, 0, 0}, {0.5f, 1e-5f, 0}}, {0, 1, 2}, {}};
  EXPECT_EQ(build_topology(soup_of(sliver)).degenerate_triangles, 0u);
}

TEST(MeshTopology, ThreeWallsAtOneEdgeAreThreeComponents) {
  Mesh mesh{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, 1, 0}, {0, 0, 1}, {0, 1, 1}}, {}, {}};
  mesh.indices = {0, 2, 3, 0, 3, 1, 0, 1, 5, 0, 5, 4, 0, 6, 7, 0, 7, 1};
  const MeshTopology topology = build_topology(soup_of(mesh));
  EXPECT_EQ(topology.triangles.size(), 6u);
  ASSERT_EQ(topology.components.size(), 3u);
  for (const auto& wall : topology.components) EXPECT_EQ(wall.triangles.size(), 2u);
}

TEST(MeshTopology, HugeFanIsBuiltInTime) {
  Mesh fan;
  fan.positions.emplace_back(0.0f, 0.0f, 0.0f);
  const std::uint32_t count = 200000;
  for (std::uint32_t i = 0; i <= count; ++i) {
    const double angle = 6.0 * i / count;
    fan.positions.emplace_back(float(std::cos(angle)), float(std::sin(angle)), 0.0f);
    if (i > 0) fan.indices.insert(fan.indices.end(), {0, i, i + 1});
  }
  EXPECT_EQ(build_topology(soup_of(fan)).triangles.size(), count);
}

TEST(MeshTopology, ManyTrianglesAtOneEdgeAreBuiltInTime) {
  Mesh book{{{0, 0, 0}, {0, 1, 0}}, {}, {}};
  for (std::uint32_t i = 0; i < 20000; ++i) {
    book.positions.emplace_back(float(i), 0.5f, 1.0f);
    book.indices.insert(book.indices.end(), {0, 1, i + 2});
  }
  EXPECT_EQ(build_topology(soup_of(book)).triangles.size(), 20000u);
}

}  // namespace
}  // namespace patchlight::test
