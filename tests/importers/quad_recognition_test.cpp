#include "importers/quad_recognition.h"

#include <gtest/gtest.h>

#include "tests/importers/mesh_shapes.h"

namespace patchlight::test {
namespace {

bool is_quad(const Facet& facet) {
  return facet.corners[2] != facet.corners[3];
}

std::vector<Facet> facets_of(const Mesh& mesh) {
  const MeshTopology topology = build_topology(soup_of(mesh));
  return recognize_quads(topology, std::vector<char>(topology.triangles.size(), 0));
}

TEST(QuadRecognition, CubeIsSixQuadsFacingOut) {
  const std::vector<Facet> facets = facets_of(cube());
  ASSERT_EQ(facets.size(), 6u);
  for (const Facet& facet : facets) {
    const auto& c = facet.corners;
    const Vec3d middle = (c[0] + c[1] + c[2] + c[3]) * 0.25;
    EXPECT_TRUE(is_quad(facet));
    EXPECT_NEAR((c[2] - c[0]).cross(c[3] - c[1]).normalized().dot(middle), 1.0, 1e-12);
  }
}

TEST(QuadRecognition, GridIsItsRectangles) {
  const std::vector<Facet> facets = facets_of(grid(10));
  ASSERT_EQ(facets.size(), 100u);
  for (const Facet& facet : facets) {
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR((facet.corners[(i + 1) % 4] - facet.corners[i]).length(), 1.0, 1e-12);
    }
  }
}

TEST(QuadRecognition, NeighboursOnAFlatGridShareSmoothVertices) {
  std::vector<int> uses(200, 0);
  for (const Facet& facet : facets_of(grid(10)))
    for (const int id : facet.smooth_vertices) ++uses.at(std::size_t(id));
  EXPECT_EQ(std::count(uses.begin(), uses.end(), 4), 81);
  EXPECT_EQ(std::count(uses.begin(), uses.end(), 1), 4);
}

TEST(QuadRecognition, FoldedPairStaysTwoTriangles) {
  const std::vector<Facet> facets = facets_of(quad_mesh({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.02f}, {0, 1, 0}}}));
  ASSERT_EQ(facets.size(), 2u);
  EXPECT_FALSE(is_quad(facets[0]) || is_quad(facets[1]));
}

TEST(QuadRecognition, NonConvexPairStaysTwoTriangles) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {2, -1, 0}, {0.5f, 0, 0}, {2, 1, 0}}})).size(), 2u);
}

TEST(QuadRecognition, PairThatIsATriangleStaysTwo) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {1, 0, 0}, {0.5f, 0.5f, 0}, {0, 1, 0}}})).size(), 2u);
}

TEST(QuadRecognition, TrapezoidIsAQuad) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {3, 0, 0}, {2, 1, 0}, {1, 1, 0}}})).size(), 1u);
}

TEST(QuadRecognition, RectangleOfTenThousandToOneIsAQuad) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {10000, 0, 0}, {10000, 1, 0}, {0, 1, 0}}})).size(), 1u);
}

TEST(QuadRecognition, SliversFoldedAlongTheirLongEdgeStayTwo) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {1, 0, 5e-5f}, {2, 0, 0}, {1, 5e-5f, 0}}})).size(), 2u);
}

TEST(QuadRecognition, OppositeFacesOfAThinSheetAreNotPaired) {
  Mesh sheet = truncated(grid(1), 1);
  sheet.indices.insert(sheet.indices.end(), {0, 3, 1});
  for (const Facet& facet : facets_of(sheet)) EXPECT_FALSE(is_quad(facet));
}

TEST(QuadRecognition, TriangleRepeatsItsLastCorner) {
  const std::vector<Facet> facets = facets_of({{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}}, {0, 1, 2}, {}});
  ASSERT_EQ(facets.size(), 1u);
  EXPECT_EQ(facets[0].corners[2], facets[0].corners[3]);
  EXPECT_EQ(facets[0].smooth_vertices[2], facets[0].smooth_vertices[3]);
  EXPECT_EQ(facets[0].corners[2], Vec3d(0, 0, 0));  // opposite its shortest edge
}

}  // namespace
}  // namespace patchlight::test
