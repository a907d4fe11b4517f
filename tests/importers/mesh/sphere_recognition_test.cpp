#include "importers/mesh/sphere_recognition.h"

#include <gtest/gtest.h>

#include "tests/importers/mesh/mesh_shapes.h"

namespace patchlight::test {
namespace {

std::vector<Sphere> spheres_in(const Mesh& mesh, const Vec3d& offset = Vec3d(0.0)) {
  TriangleSoup soup = soup_of(mesh);
  for (Vec3d& p : soup.positions) p += offset;
  const MeshTopology topology = build_topology(soup);
  std::vector<Sphere> spheres;
  for (const auto& component : topology.components)
    if (const auto sphere = recognize_sphere(topology, component)) spheres.push_back(*sphere);
  return spheres;
}

/// A mesh with the normals of a sphere about the origin.
Mesh smooth(Mesh mesh) {
  mesh.normals.clear();
  for (const Vec3f& p : mesh.positions) mesh.normals.push_back(p.normalized());
  return mesh;
}

void expect_unit_sphere(const std::vector<Sphere>& spheres, double radius, const Vec3d& center) {
  ASSERT_EQ(spheres.size(), 1u);
  EXPECT_NEAR(spheres[0].radius, radius, 1e-6);
  EXPECT_NEAR((spheres[0].center - center).length(), 0.0, 1e-6);
}

TEST(SphereRecognition, UvSphereGivesCentreAndRadius) {
  expect_unit_sphere(spheres_in(uv_sphere(32, 16), {1, 2, 3}), 1.0, {1, 2, 3});
}

TEST(SphereRecognition, SphereFarFromTheOriginIsRecognized) {
  expect_unit_sphere(spheres_in(uv_sphere(32, 16), {10000, 0, 10000}), 1.0, {10000, 0, 10000});
}

TEST(SphereRecognition, CoarseUvSphereIsASphere) {
  expect_unit_sphere(spheres_in(smooth(uv_sphere(16, 8))), 1.0, Vec3d(0.0));
}
TEST(SphereRecognition, IcosphereOf80IsASphere) {
  expect_unit_sphere(spheres_in(smooth(icosphere(1))), 1.0, Vec3d(0.0));
}
TEST(SphereRecognition, IcosphereOf320IsASphere) {
  expect_unit_sphere(spheres_in(smooth(icosphere(2))), 1.0, Vec3d(0.0));
}

TEST(SphereRecognition, InwardSphereHasANegativeRadius) {
  expect_unit_sphere(spheres_in(inverted(uv_sphere(32, 16))), -1.0, Vec3d(0.0));
}

TEST(SphereRecognition, TwoSpheresInOneMeshAreBothRecognized) {
  Mesh mesh = uv_sphere(32, 16);
  const auto count = std::uint32_t(mesh.positions.size());
  const Mesh other = scaled(uv_sphere(32, 16), Vec3f(0.5f));
  for (const Vec3f& p : other.positions) mesh.positions.push_back(p + Vec3f(4, 0, 0));
  for (const std::uint32_t index : other.indices) mesh.indices.push_back(index + count);
  EXPECT_EQ(spheres_in(mesh).size(), 2u);
}

TEST(SphereRecognition, EllipsoidStaysAMesh) {
  EXPECT_TRUE(spheres_in(smooth(scaled(uv_sphere(32, 16), {1.0f, 1.0f, 1.01f}))).empty());
}

TEST(SphereRecognition, HalfASphereStaysAMesh) {
  const Mesh whole = smooth(icosphere(2));
  EXPECT_TRUE(spheres_in(truncated(whole, whole.indices.size() / 6)).empty());
}

TEST(SphereRecognition, SphereWithAHoleStaysAMesh) {
  const Mesh whole = smooth(icosphere(2));
  EXPECT_TRUE(spheres_in(truncated(whole, whole.indices.size() / 3 - 1)).empty());
}

TEST(SphereRecognition, BoxWhoseCornersLieOnASphereStaysAMesh) {
  EXPECT_TRUE(spheres_in(smooth(cube())).empty());
}
TEST(SphereRecognition, IcosahedronStaysAMesh) {
  EXPECT_TRUE(spheres_in(smooth(icosphere(0))).empty());
}

TEST(SphereRecognition, OneMovedVertexMakesItAMesh) {
  Mesh mesh = smooth(icosphere(2));
  mesh.positions[7] *= 1.01f;
  EXPECT_TRUE(spheres_in(mesh).empty());
}

TEST(SphereRecognition, CoarseBallsWithFlatFacetsStayMeshes) {
  for (const Mesh& ball : {uv_sphere(12, 8), uv_sphere(16, 8), icosphere(1), icosphere(2)}) {
    EXPECT_TRUE(spheres_in(ball).empty()) << "no normals: flat";
    EXPECT_EQ(spheres_in(smooth(ball)).size(), 1u);
  }
  EXPECT_EQ(spheres_in(uv_sphere(32, 16)).size(), 1u) << "its facets hardly show";
}

}  // namespace
}  // namespace patchlight::test
