#include "importers/mesh/quad_recognition.h"

#include <gtest/gtest.h>

#include <map>

#include "pipeline/model/patch_set.h"
#include "tests/importers/mesh/mesh_shapes.h"

namespace patchlight::test {
namespace {

bool is_quad(const Facet& facet) {
  return facet.corners[2] != facet.corners[3];
}

std::vector<Facet> facets_of(const Mesh& mesh) {
  const MeshTopology topology = build_topology(soup_of(mesh));
  return recognize_quads(topology, std::vector<char>(topology.triangles.size(), 0), false).facets;
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

/// A grid bent onto a cylinder of radius 20 about an axis along Y, shaded smoothly.
Mesh arch(std::uint32_t n) {
  Mesh mesh = grid(n);
  for (Vec3f& p : mesh.positions) {
    const double angle = p.x / 20.0;
    mesh.normals.emplace_back(Vec3d(std::sin(angle), 0.0, std::cos(angle)));
    p = Vec3f(Vec3d(20 * std::sin(angle), p.y, 20 * std::cos(angle)));
  }
  return mesh;
}

TEST(QuadRecognition, FlatSurfacesWhoseNormalsVaryStayInPieces) {
  Mesh mesh = grid(4);  // a pillow by its normals: plane, with normals that lean outwards
  for (const Vec3f& p : mesh.positions)
    mesh.normals.push_back(Vec3f(0.2f * (p.x - 2) * std::abs(p.x - 2), 0, 1).normalized());
  EXPECT_EQ(facets_of(mesh).size(), 4u) << "a strip for each column";
  for (Vec3f& n : mesh.normals) n = {0, 0, 1};
  EXPECT_EQ(facets_of(mesh).size(), 1u);
  for (std::size_t k = 0; k < mesh.normals.size(); ++k) mesh.normals[k] = Vec3f(0.1f * mesh.positions[k].x, 0, 1);
  EXPECT_EQ(facets_of(mesh).size(), 1u) << "affine: those at the corners tell all";
}

/// The cells of an n x n grid for which `inside(x, y)`.
template <class Inside>
Mesh cells(std::uint32_t n, const Inside& inside) {
  Mesh mesh = grid(n), result{mesh.positions, {}, {}};
  for (std::uint32_t cell = 0; cell < n * n; ++cell) {
    if (!inside(cell % n, cell / n)) continue;
    const auto first = mesh.indices.begin() + 6 * std::ptrdiff_t(cell);
    result.indices.insert(result.indices.end(), first, first + 6);
  }
  return result;
}

double area_of(const std::vector<Facet>& facets) {
  double area = 0.0;
  for (const Facet& f : facets)
    area += 0.5 * (f.corners[2] - f.corners[0]).cross(f.corners[3] - f.corners[1]).dot(Vec3d(0, 0, 1));
  return area;
}

TEST(QuadRecognition, CurvedSurfaceBecomesRectanglesThatShareSmoothVertices) {
  const std::vector<Facet> facets = facets_of(arch(10));
  ASSERT_EQ(facets.size(), 100u);
  std::vector<int> uses(200, 0);
  for (const Facet& facet : facets) {
    EXPECT_TRUE(is_quad(facet));
    for (const int id : facet.smooth_vertices) ++uses.at(std::size_t(id));
  }
  EXPECT_EQ(std::count(uses.begin(), uses.end(), 4), 81);
  EXPECT_EQ(std::count(uses.begin(), uses.end(), 1), 4);
}

TEST(QuadRecognition, FlatGridIsOneQuad) {
  for (const std::uint32_t n : {2u, 10u, 100u}) {
    const std::vector<Facet> facets = facets_of(grid(n));
    ASSERT_EQ(facets.size(), 1u);
    EXPECT_TRUE(is_quad(facets[0]));
    EXPECT_EQ(area_of(facets), double(n) * n);
    for (const Vec3d& corner : facets[0].corners) {
      EXPECT_TRUE(corner.x == 0 || corner.x == n);
      EXPECT_TRUE(corner.y == 0 || corner.y == n);
    }
  }
}

TEST(QuadRecognition, FlatShapesBecomeTheFewestRectangles) {
  const auto expect = [](std::size_t count, double area, const Mesh& mesh, const char* what) {
    const std::vector<Facet> facets = facets_of(mesh);
    EXPECT_EQ(facets.size(), count) << what;
    EXPECT_NEAR(area_of(facets), area, 1e-9) << what;
    for (const Facet& facet : facets) {
      const auto& c = facet.corners;
      EXPECT_NEAR((c[1] - c[0]).dot(c[2] - c[1]), 0.0, 1e-9) << what;
      EXPECT_NEAR((c[3] - c[2]).dot(c[0] - c[3]), 0.0, 1e-9) << what;
    }
  };
  expect(2, 75, cells(10, [](auto x, auto y) { return x < 5 || y < 5; }), "L");
  expect(3, 80, cells(10, [](auto x, auto y) { return y >= 5 || x < 3 || x >= 7; }), "door");
  expect(4, 92, cells(10, [](auto x, auto y) { return x < 3 || x >= 7 || y < 4 || y >= 6; }), "window");
  expect(5, 88, cells(10, [](auto x, auto y) { return y < 3 || y >= 6 || x % 5 < 1 || x % 5 > 2; }),
         "two windows side by side");
  expect(3, 36, cells(10, [](auto x, auto y) { return (x >= 4 && x < 6) || (y >= 4 && y < 6); }), "cross");
}

TEST(QuadRecognition, NewCornersOnEdgesAreSharedByTheirFacets) {
  const std::vector<Facet> facets = facets_of(cells(10, [](auto x, auto y) { return x < 5 || y < 5; }));
  std::map<std::int32_t, Vec3d> places;
  for (const Facet& facet : facets) {
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [entry, is_new] = places.emplace(facet.smooth_vertices[i], facet.corners[i]);
      EXPECT_EQ(entry->second, facet.corners[i]);
    }
  }
  EXPECT_EQ(places.size(), 7u);  // six corners of the outline and one new
}

TEST(QuadRecognition, GableBecomesAtMostTwoTrapezoids) {
  Mesh gable = grid(8);
  for (Vec3f& p : gable.positions) {
    const float roof = 8 + 4 - std::abs(p.x - 4);
    p.y *= roof / 8;
  }
  const std::vector<Facet> facets = facets_of(gable);
  EXPECT_LE(facets.size(), 2u);
  EXPECT_NEAR(area_of(facets), 80.0, 1e-5);
}

TEST(QuadRecognition, DiscKeepsItsTriangles) {
  Mesh disc;
  for (int i = 0; i < 32; ++i) disc.positions.emplace_back(Vec3d(std::cos(i * kPi / 16), std::sin(i * kPi / 16), 0));
  for (std::uint32_t i = 1; i + 1 < 32; ++i) disc.indices.insert(disc.indices.end(), {0, i, i + 1});
  const std::vector<Facet> facets = facets_of(disc);
  EXPECT_EQ(facets.size(), 15u);
  EXPECT_NEAR(area_of(facets), 16 * std::sin(kPi / 16), 1e-6);
}

TEST(QuadRecognition, RegionsEndAtFolds) {
  Mesh step = grid(10);
  for (Vec3f& p : step.positions) p.z = p.x > 5 ? (p.x - 5) * 0.1f : 0.0f;
  EXPECT_EQ(facets_of(step).size(), 2u);
  for (Vec3f& p : step.positions) p.z = p.x * p.x * 0.01f;
  EXPECT_EQ(facets_of(step).size(), 10u) << "a crease along each row of cells";
}

TEST(QuadRecognition, RotatedRegionsFarFromTheOriginAreMerged) {
  Mesh floor = grid(20);
  Imath::M44d place;
  place.rotate(Vec3d(0.3, 0.5, 0.7));
  place[3][0] = 100;
  place[3][1] = 50;
  for (Vec3f& p : floor.positions) p = Vec3f(Vec3d(p) * 0.05 * place);
  TriangleSoup soup = soup_of(floor);
  soup.rounding = 1e-5;
  const MeshTopology topology = build_topology(soup);
  EXPECT_EQ(recognize_quads(topology, std::vector<char>(topology.triangles.size(), 0), false).facets.size(), 1u);
}

TEST(QuadRecognition, MergedQuadKeepsTheTextureMappingOfItsTriangles) {
  const Mesh floor = grid(10);
  const auto facets_with = [&](const auto& mapping) {
    TriangleSoup soup = soup_of(floor);
    soup.texcoords.emplace_back();
    for (const Vec3d& p : soup.positions) soup.texcoords[0].push_back(mapping(p));
    const MeshTopology topology = build_topology(soup);
    std::vector<std::pair<Facet, Texcoords>> facets;
    for (const Facet& f : recognize_quads(topology, std::vector<char>(topology.triangles.size(), 0), false).facets) {
      Texcoords& at = facets.emplace_back(f, Texcoords{}).second;
      for (std::size_t i = 0; i < 4; ++i) at[i] = f.sources[i](topology.texcoords[0]);
    }
    return facets;
  };
  const auto affine = [](const Vec3d& p) { return Vec2f(float(0.3 * p.x - 0.1 * p.y + 2), float(0.2 * p.y)); };
  const auto one = facets_with(affine);
  ASSERT_EQ(one.size(), 1u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(one[0].second[i], affine(one[0].first.corners[i]));
  EXPECT_EQ(facets_with([](const Vec3d& p) { return Vec2f(float(std::abs(p.x - 5)), float(p.y)); }).size(), 2u)
      << "mirrored about x = 5";
  EXPECT_EQ(facets_with([](const Vec3d& p) { return Vec2f(float(p.x * p.x), float(p.y)); }).size(), 10u);
}

TEST(QuadRecognition, FoldedPairStaysTwoTriangles) {
  const std::vector<Facet> facets = facets_of(quad_mesh({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.02f}, {0, 1, 0}}}));
  ASSERT_EQ(facets.size(), 2u);
  EXPECT_FALSE(is_quad(facets[0]) || is_quad(facets[1]));
}

TEST(QuadRecognition, NonConvexPairStaysTwoTriangles) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {2, -1, 0}, {0.5f, 0, 0}, {2, 1, 0}}})).size(), 2u);
}

TEST(QuadRecognition, PairThatFormsATriangleStaysTwoTriangles) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {1, 0, 0}, {0.5f, 0.5f, 0}, {0, 1, 0}}})).size(), 2u);
}

TEST(QuadRecognition, TrapezoidIsAQuad) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {3, 0, 0}, {2, 1, 0}, {1, 1, 0}}})).size(), 1u);
}

TEST(QuadRecognition, RectangleOfTenThousandToOneIsAQuad) {
  EXPECT_EQ(facets_of(quad_mesh({{{0, 0, 0}, {10000, 0, 0}, {10000, 1, 0}, {0, 1, 0}}})).size(), 1u);
}

TEST(QuadRecognition, SliversFoldedAlongTheirLongEdgeStayTwoTriangles) {
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
