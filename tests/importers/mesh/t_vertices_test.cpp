#include "importers/mesh/t_vertices.h"

#include <ImathQuat.h>
#include <gtest/gtest.h>

#include <numeric>

#include "importers/mesh/mesh_topology.h"
#include "importers/mesh/quad_recognition.h"
#include "tests/importers/mesh/mesh_shapes.h"

namespace patchlight::test {
namespace {

/// A wall of 4 m by 3 m in rows of tiles that do not meet at their corners, as a file of floats gives it.
/// `turn`: about an oblique axis, so that coordinates are rounded.
TriangleSoup tiled_wall(double turn) {
  TriangleSoup soup;
  const Imath::Quatd quaternion = Imath::Quatd().setAxisAngle(Vec3d(1, 2, 3).normalized(), turn);
  const auto add = [&](double x, double y) {
    const Vec3d turned = quaternion.rotateVector(Vec3d(x, y, 0.1)) + Vec3d(7, 5, 3);
    soup.positions.emplace_back(Vec3f(turned));
    soup.normals.emplace_back(Vec3f(quaternion.rotateVector(Vec3d(0, 0, 1))));
  };
  soup.texcoords.emplace_back();
  constexpr std::array kTiles{3, 5, 2, 7, 4, 3};
  for (std::size_t row = 0; row < kTiles.size(); ++row)
    for (int k = 0; k < kTiles[row]; ++k) {
      const double x0 = 4.0 * k / kTiles[row], x1 = 4.0 * (k + 1) / kTiles[row], y0 = 0.5 * double(row), y1 = y0 + 0.5;
      for (const auto& [x, y] : {std::pair(x0, y0), {x1, y0}, {x1, y1}, {x0, y0}, {x1, y1}, {x0, y1}}) {
        add(x, y);
        soup.texcoords[0].emplace_back(float(x), float(y));
      }
    }
  soup.rounding = 15 * 0x1p-24;
  return soup;
}

double area_of(const MeshTopology& topology) {
  return std::accumulate(topology.triangles.begin(), topology.triangles.end(), 0.0,
                         [](double sum, const auto& triangle) { return sum + triangle.area; });
}

TEST(TVertices, TilesThatDoNotMeetAtTheirCornersAreOneWall) {
  for (const double turn : {0.0, 1.0, 2.5}) {
    const TriangleSoup soup = tiled_wall(turn);
    const MeshTopology topology = build_topology(soup);
    EXPECT_EQ(topology.components.size(), 1u);
    EXPECT_NEAR(area_of(topology), 12.0, 1e-5);
    const RecognizedFacets facets = recognize_quads(topology, std::vector<char>(topology.triangles.size(), 0), true);
    ASSERT_EQ(facets.facets.size(), 1u) << turn;
    for (std::size_t k = 0; k < 4; ++k) {  // texture coordinates are positions on the wall
      const Vec2f at = facets.facets[0].sources[k](topology.texcoords[0]);
      EXPECT_NEAR(std::abs(at.x - 2.0f), 2.0f, 1e-5f);
      EXPECT_NEAR(std::abs(at.y - 1.5f), 1.5f, 1e-5f);
    }
  }
}

TEST(TVertices, ValuesAtNewCornersAreInterpolated) {
  const TriangleSoup soup = tiled_wall(1.0);
  const auto split = split_at_t_vertices(soup, soup.positions);
  ASSERT_TRUE(split);
  ASSERT_GT(split->positions.size(), soup.positions.size());
  const Vec3d origin = soup.positions[0];
  for (std::size_t k = 0; k < split->positions.size(); ++k) {
    EXPECT_NEAR((split->positions[k] - origin).length(), double(split->texcoords[0][k].length()), 1e-5);
    EXPECT_NEAR(split->normals[k].length(), 1.0f, 1e-5f);
  }
}

TEST(TVertices, VerticesBesideAnEdgeDoNotSplitIt) {
  TriangleSoup soup = tiled_wall(0.0);
  for (std::size_t k = 0; k < 18; ++k) soup.positions[k].y -= 1e-4;  // the lowest row
  EXPECT_EQ(build_topology(soup).components.size(), 2u);
}

TEST(TVertices, AWallThatStandsOnAnEdgeOfAFloorDoesNotSplitItUnlessItRunsAlong) {
  const auto count = [](const Vec3f& to) {
    Mesh mesh = grid(1);  // a second wall stands on the middle of its edge y = 0
    const auto k = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {Vec3f(0.5f, 0, 0), to, Vec3f(0.5f, 0, 1)});
    mesh.indices.insert(mesh.indices.end(), {k, k + 1, k + 2});
    TriangleSoup soup = soup_of(mesh);
    soup.rounding = 0x1p-24;
    return build_topology(soup).triangles.size();
  };
  EXPECT_EQ(count(Vec3f(0.5f, -1, 0)), 3u);
  EXPECT_EQ(count(Vec3f(1.0f, 0, 0)), 4u);
}

TEST(TVertices, ACombOfTrianglesOnOneLineStaysAsItIs) {
  TriangleSoup soup;
  for (int k = 0; k < 20000; ++k)
    for (const Vec3d& p : {Vec3d(-1e-4 * k, 0, 0), Vec3d(1 + 1e-4 * k, 0, 0), Vec3d(0.5, 1, k)}) {
      soup.positions.push_back(p);
      soup.normals.emplace_back(0.0f);
    }
  soup.rounding = 1e-9;
  EXPECT_FALSE(split_at_t_vertices(soup, soup.positions));
}

}  // namespace
}  // namespace patchlight::test
