#include "importers/mesh/open_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "importers/mesh/sphere_recognition.h"
#include "tests/importers/mesh/mesh_shapes.h"

namespace patchlight::test {
namespace {

/// A sphere as many generators make it: its first and last meridian have vertices of their own, each with its own sine
/// and cosine, and so has each triangle at a pole. `noise`: of the vertices, m.
Mesh generated_sphere(int around, int rings, float radius, float noise) {
  Mesh mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> error(-noise, noise);
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i <= around; ++i) {
      const double u = 2 * kPi * i / around, v = kPi * j / rings;
      const Vec3f normal(Vec3d(-std::cos(u) * std::sin(v), std::cos(v), std::sin(u) * std::sin(v)));
      mesh.normals.push_back(normal);
      mesh.positions.push_back(normal * radius + Vec3f(error(random), error(random), error(random)));
    }
  for (std::uint32_t j = 0; j < std::uint32_t(rings); ++j)
    for (std::uint32_t i = 0; i < std::uint32_t(around); ++i) {
      const std::uint32_t row = std::uint32_t(around) + 1, a = j * row + i + 1, b = j * row + i;
      if (j > 0) mesh.indices.insert(mesh.indices.end(), {a, b, a + row});
      if (j + 1 < std::uint32_t(rings)) mesh.indices.insert(mesh.indices.end(), {b, b + row, a + row});
    }
  return mesh;
}

/// As a file of floats gives it.
TriangleSoup float_soup(const Mesh& mesh) {
  TriangleSoup soup = soup_of(mesh);
  for (const Vec3f& p : mesh.positions)
    for (int k = 0; k < 3; ++k) soup.rounding = std::max(soup.rounding, 0x1p-24 * std::abs(double(p[k])));
  return soup;
}

TEST(OpenEdges, SeamsAndPolesOfGeneratedSpheresClose) {
  for (const auto& [around, rings] : {std::pair(32, 16), {64, 32}})
    for (const float radius : {0.15f, 1.0f, 300.0f})
      for (const float noise : {0.0f, 3e-7f}) {
        const MeshTopology topology =
            build_topology(float_soup(generated_sphere(around, rings, radius, noise * radius)));
        ASSERT_EQ(topology.components.size(), 1u);
        EXPECT_TRUE(topology.components[0].closed) << around << " " << radius << " " << noise;
        const auto sphere = recognize_sphere(topology, topology.components[0]);
        ASSERT_TRUE(sphere);
        EXPECT_NEAR(sphere->radius / double(radius), 1.0, 1e-5);
      }
}

TEST(OpenEdges, SmallDetailsFarFromTheOriginStay) {
  Mesh mesh = grid(8);  // of cells smaller than the tolerance, 0.04 m at 10 km
  for (Vec3f& p : mesh.positions) p = p * 0.03125f + Vec3f(8192, 0, 0);
  const MeshTopology topology = build_topology(float_soup(mesh));
  EXPECT_EQ(topology.vertices.size(), 81u);
  EXPECT_EQ(topology.degenerate_triangles, 0u);
}

TEST(OpenEdges, GapsThatTheFileCanTellStayOpen) {
  Mesh mesh = grid(1);
  const auto count = std::uint32_t(mesh.positions.size());
  for (std::uint32_t k = 0; k < count; ++k) mesh.positions.push_back(mesh.positions[k] + Vec3f(1.0001f, 0, 0));
  for (std::size_t k = 0; k < 6; ++k) mesh.indices.push_back(mesh.indices[k] + count);
  EXPECT_EQ(build_topology(float_soup(mesh)).components.size(), 2u);
  for (std::uint32_t k = count; k < 2 * count; ++k) mesh.positions[k].x -= 0.0001f;
  EXPECT_EQ(build_topology(float_soup(mesh)).components.size(), 1u);
}

TEST(OpenEdges, ManyLooseTrianglesInOnePlaceTakeLittleTime) {
  Mesh mesh;
  for (std::uint32_t k = 0; k < 60000; ++k) {
    mesh.positions.insert(mesh.positions.end(),
                          {{float(k) * 1e-12f, 0, 0}, {1, float(k) * 1e-5f, 0}, {0, 1, float(k)}});
    mesh.indices.insert(mesh.indices.end(), {3 * k, 3 * k + 1, 3 * k + 2});
  }
  EXPECT_EQ(with_closed_seams(float_soup(mesh)).size(), mesh.indices.size());
}

}  // namespace
}  // namespace patchlight::test
