#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/solver/display/display_scenes.h"

namespace patchlight {
namespace {

using test::mesh_of;
using test::PatchScene;

/// A smooth rail of two facets, 60 cm long and bent along the middle, whose ends lie in double-sided posts of 10 cm.
PatchSet rail(const std::vector<double>& posts) {
  PatchScene builder;
  const std::array<Vec3d, 3> across{Vec3d(0, 0, 0.02), Vec3d(0, 0.005, 0), Vec3d(0, 0, -0.02)};
  for (int k = 0; k < 2; ++k) {
    const Vec3d along(0.3, 0, 0);
    const int facet =
        builder.quad({across[k] - along, across[k] + along, across[k + 1] + along, across[k + 1] - along}, 1, 1, {});
    builder.get().primitives[facet].smooth_vertices = {2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2};
  }
  for (const double x : posts) {
    PatchScene post;
    post.room(0.05, 1, {});
    for (const Primitive& wall : post.get().primitives) {
      std::array<Vec3d, 4> c = wall.corners;
      for (Vec3d& corner : c) corner.x += x;
      const int inside = builder.quad(c, 1, 1, {}), outside = builder.quad({c[1], c[0], c[3], c[2]}, 1, 1, {});
      builder.get().primitives[inside].back = outside;
      builder.get().primitives[outside].back = inside;
    }
  }
  return builder.get();
}

/// Where the corners of the facets on a scene's first two primitives gather, m along the rail.
std::vector<double> places_along_rail(const PatchSet& scene) {
  const DisplayMesh mesh = mesh_of(scene);
  std::vector<double> places;
  for (const DisplayMesh::Facet& facet : mesh.facets) {
    if (scene.patches[facet.patch].primitive > 1) continue;
    for (const std::int32_t corner : facet.corners) {
      EXPECT_LT(corner, mesh.gathered);
      const DisplayMesh::Vertex& vertex = mesh.vertices[corner];
      const auto& corners = scene.primitives[scene.patches[vertex.patch].primitive].corners;
      places.push_back(position_at(corners, vertex.u, vertex.v).x);
    }
  }
  return places;
}

TEST(DisplayFacets, VerticesAreNotInOtherBodies) {
  const std::vector<double> places = places_along_rail(rail({-0.3, 0.3})),
                            one_end_free = places_along_rail(rail({0.3}));
  ASSERT_EQ(places.size(), 8u);
  ASSERT_EQ(one_end_free.size(), 8u);
  for (const double x : places) EXPECT_LT(std::abs(x), 0.25);
  for (const double x : one_end_free)
    EXPECT_TRUE(x < -0.28 || (x > 0.2 && x < 0.25)) << x << ": corners stay where free";
}

TEST(DisplayFacets, VerticesAreWhereTheLargestFacetIsOpen) {
  PatchScene builder;  // a facet of 15 mm that continues the rail, all of it in the post
  const int small =
      builder.quad({{{-0.315, 0, 0.02}, {-0.3, 0, 0.02}, {-0.3, 0.005, 0}, {-0.315, 0.005, 0}}}, 1, 1, {});
  builder.get().primitives[small].smooth_vertices = {6, 0, 2, 7};
  PatchSet scene = rail({-0.3, 0.3});
  scene.primitives.push_back(builder.get().primitives[small]);
  scene.patches.push_back(builder.get().patches[0]);
  scene.patches.back().primitive = std::int32_t(scene.primitives.size()) - 1;
  for (const double x : places_along_rail(scene)) EXPECT_LT(std::abs(x), 0.25);
}

TEST(DisplayFacets, OfClustersTakeTheirLightFromFewVertices) {
  constexpr int kAround = 24, kUp = 24;
  std::vector<std::array<Vec3d, 4>> pole;
  const auto at = [](int k, int j) {
    const double angle = 2 * kPi * (k % kAround) / kAround;
    return Vec3d(0.1 * std::cos(angle), -0.5 + double(j) / kUp, -0.1 * std::sin(angle));
  };
  for (int j = 0; j < kUp; ++j)
    for (int k = 0; k < kAround; ++k) pole.push_back({at(k, j), at(k + 1, j), at(k + 1, j + 1), at(k, j + 1)});
  PatchScene builder;
  builder.room(2, 4, {});
  builder.cluster(pole, {});
  for (Primitive& p : builder.get().primitives) p.patch_area = 0.25;
  const DisplayMesh mesh = mesh_of(builder.get());
  ASSERT_EQ(mesh.facets.size(), pole.size());
  std::set<std::int32_t> vertices;
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    EXPECT_EQ(mesh.facets[i].facet, std::int32_t(i));
    for (const std::int32_t corner : mesh.facets[i].corners) {
      ASSERT_GE(corner, 0);
      if (corner < mesh.gathered) vertices.insert(corner);
    }
  }
  EXPECT_GT(vertices.size(), 8u);
  EXPECT_LT(vertices.size(), 100u) << "of 600 corners";
  ASSERT_EQ(mesh.blends.size() + vertices.size(), std::size_t(kAround * (kUp + 1)));
  for (const DisplayMesh::Blend& blend : mesh.blends) {
    float sum = 0;
    for (const DisplayMesh::Part& part : mesh.parts_of(blend)) {
      sum += part.weight;
      EXPECT_TRUE(vertices.contains(part.vertex));
    }
    EXPECT_NEAR(sum, 1, 1e-5);
  }
}

}  // namespace
}  // namespace patchlight
