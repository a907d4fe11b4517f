#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/transport/elements.h"
#include "tests/alpha_mask_scene.h"
#include "tests/solver/display/display_scenes.h"

namespace patchlight {
namespace {

using test::divided_room;
using test::drum_above_a_floor;
using test::mesh_of;
using test::PatchScene;

TEST(DisplayMesh, DividesOnlyPatchesAlongCreases) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 16, 16, {});
  EXPECT_EQ(mesh_of(builder.get()).cells.size(), 0u);
  builder.quad({{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}}, 16, 16, {});
  const DisplayMesh mesh = mesh_of(builder.get());
  for (int i = 0; i < 256; ++i) {
    if (i % 16 == 0) {
      EXPECT_GE(mesh.roots[i], 0) << "patch " << i;
    } else if (i % 16 > 3) {
      EXPECT_LT(mesh.roots[i], 0) << "patch " << i;
    }
  }
  EXPECT_GT(mesh.gathered, 100);
  for (std::size_t k = mesh.gathered; k < mesh.vertices.size() - mesh.midpoints.size(); ++k)
    EXPECT_TRUE(mesh.vertices[k].patch >= 256 || mesh.vertices[k].patch % 16 > 0) << "borders are not at the crease";
}

TEST(DisplayMesh, LeavesCoverTheirPatches) {
  PatchScene builder = divided_room();
  builder.sphere({0.5, -0.8, 0.3}, 0.2, 8, 12, {});
  const PatchSet& scene = builder.get();
  const DisplayMesh mesh = mesh_of(scene);
  const std::vector<Patch> leaves = leaf_patches(scene, mesh);
  double area = 0, whole = 0;
  for (std::size_t i = 0; i < mesh.roots.size(); ++i) whole += mesh.roots[i] >= 0 ? scene.patches[i].area : 0.0;
  for (const Patch& leaf : leaves) area += leaf.area;
  double cut = 0;
  for (std::size_t i = 0; i < mesh.roots.size(); ++i) {
    if (mesh.roots[i] < 0) continue;
    const Patch& patch = scene.patches[i];
    for (float x = 0.01f; x < 1; x += 0.06f)
      for (float y = 0.01f; y < 1; y += 0.06f) {
        const float u = patch.u0 + x * (patch.u1 - patch.u0), v = patch.v0 + y * (patch.v1 - patch.v0);
        const DisplayMesh::Place place = mesh.find(std::int32_t(i), patch, u, v);
        ASSERT_LT(place.leaf->children, 0);
        if (place.leaf->cut) {
          cut += patch.area / (17 * 17);
          continue;
        }
        const Patch& leaf = leaves[place.leaf->leaf];
        ASSERT_TRUE(leaf.u0 <= u && u <= leaf.u1 && leaf.v0 <= v && v <= leaf.v1);
        ASSERT_NEAR(leaf.u0 + place.u * (leaf.u1 - leaf.u0), u, 1e-5);
      }
  }
  EXPECT_NEAR(area + cut, whole, 0.01 * whole);
  EXPECT_GT(cut, 0);
  for (const Patch& leaf : leaves) EXPECT_NEAR(leaf.normal.length(), 1, 1e-5);
}

TEST(DisplayMesh, DoesNotDivideFacetsOfCurvedMeshes) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 4, {});
  builder.quad({{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}}, 4, 1, {});
  EXPECT_GE(mesh_of(builder.get()).roots[0], 0);
  builder.get().primitives[0].smooth_vertices = {0, 1, 2, 3};
  builder.get().primitives[1].smooth_vertices = {0, 3, 4, 5};
  EXPECT_EQ(mesh_of(builder.get()).cells.size(), 0u);
}

TEST(DisplayMesh, HasVerticesForFacetsNearOtherSurfaces) {
  const PatchScene near = drum_above_a_floor(0, 8), far = drum_above_a_floor(1.9, 1);
  EXPECT_EQ(mesh_of(PatchScene(far).get()).facets.size(), 0u);
  const DisplayMesh mesh = mesh_of(PatchScene(near).get());
  ASSERT_GE(mesh.facets.size(), 32u) << "the lowest ring, and the next one, which shares its vertices";
  ASSERT_LT(mesh.facets.size(), 128u);
  const DisplayMesh::Facet &first = mesh.facets[0], &second = mesh.facets[1];
  EXPECT_EQ(first.patch, 1024);
  EXPECT_EQ(first.corners[1], second.corners[0]) << "neighbours share vertices";
  EXPECT_EQ(first.corners[3], second.corners[2]);
  for (const auto& facet : mesh.facets)
    for (const std::int32_t corner : facet.corners) EXPECT_LT(corner, mesh.gathered);
}

TEST(DisplayMesh, LeavesBesideAPanelIgnoreVerticesAtItsEdge) {
  PatchScene builder;
  builder.room(1, 8, {});  // the panel is 1 cm in front of the wall at z = -1
  builder.quad({{{-0.5, -0.5, -0.99}, {0.5, -0.5, -0.99}, {0.5, 0.5, -0.99}, {-0.5, 0.5, -0.99}}}, 4, 4, {});
  const DisplayMesh mesh = mesh_of(builder.get());
  constexpr std::int32_t kWall = 4;
  int leaves = 0;
  for (const auto& cell : mesh.cells) {
    if (cell.children >= 0) continue;
    const DisplayMesh::Vertex &low = mesh.vertices[cell.corners[0]], &high = mesh.vertices[cell.corners[3]];
    if (builder.get().patches[low.patch].primitive != kWall || std::abs(low.v - 0.75f) > 0.01f) continue;
    if (high.v < 0.76f || low.u < 0.27f || high.u > 0.73f) continue;
    ++leaves;
    EXPECT_TRUE(cell.cut && low.hidden) << low.u;
    EXPECT_FALSE(high.hidden) << high.u;
  }
  EXPECT_GE(leaves, 3);
}

TEST(DisplayMesh, LeavesWithCornersOnBothSidesOfASheetAreCut) {
  PatchScene builder;
  builder.quad({{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}}, 8, 8, {});
  constexpr double kSheet = 0.0;  // along the edges of patches, from which vertices are moved to either side
  builder.quad({{{kSheet, -1, -1}, {kSheet, 1, -1}, {kSheet, 1, 1}, {kSheet, -1, 1}}}, 4, 4, {});
  builder.quad({{{kSheet, -1, 1}, {kSheet, 1, 1}, {kSheet, 1, -1}, {kSheet, -1, -1}}}, 4, 4, {});
  test::make_sides(builder.get(), 1, 2);
  const PatchSet& scene = builder.get();
  const DisplayMesh mesh = mesh_of(scene);
  int leaves = 0;
  for (const auto& cell : mesh.cells) {
    if (cell.children >= 0) continue;
    const DisplayMesh::Vertex &low = mesh.vertices[cell.corners[0]], &high = mesh.vertices[cell.corners[3]];
    if (scene.patches[low.patch].primitive != 0) continue;
    const double a = point_at(scene.primitives[0], low.u, low.v).position.x - kSheet;
    const double b = point_at(scene.primitives[0], high.u, high.v).position.x - kSheet;
    if (a * b > 0) continue;
    ++leaves;
    EXPECT_TRUE(cell.cut) << a << " " << b;
  }
  EXPECT_GE(leaves, 8);
}

TEST(DisplayMesh, NoVertexIsTheMeanOfBothSidesOfASheet) {
  PatchScene builder;
  builder.quad({{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}}, 8, 8, {});
  for (int k = 0; k < 5; ++k) {  // a zigzag of double-sided sheets, which meets leaves of many sizes
    const double x0 = k % 2 ? 0.4 : -0.3, x1 = 0.1 - x0, z0 = 0.4 * k - 1, z1 = z0 + 0.4;
    const auto first = int(builder.get().primitives.size());
    builder.quad({{{x0, -1, z0}, {x0, 1, z0}, {x1, 1, z1}, {x1, -1, z1}}}, 4, 4, {});
    builder.quad({{{x1, -1, z1}, {x1, 1, z1}, {x0, 1, z0}, {x0, -1, z0}}}, 4, 4, {});
    test::make_sides(builder.get(), first, first + 1);
  }
  const PatchSet& scene = builder.get();
  const RayScene ray_scene(scene);
  const DisplayMesh mesh = mesh_of(scene);
  int midpoints = 0;
  for (const auto& [a, b] : mesh.midpoints) {
    const auto at = [&](std::int32_t i) {
      return point_at(scene.primitives[0], mesh.vertices[i].u, mesh.vertices[i].v).position + Vec3d(0, 0.001, 0);
    };
    if (scene.patches[mesh.vertices[a].patch].primitive != 0) continue;
    ++midpoints;
    const Vec3f across(at(b) - at(a));
    RayPacket packet;
    packet.clear();
    packet.set_shadow(0, ray_scene.to_local(at(a)), across.normalized(), across.length());
    EXPECT_EQ(ray_scene.occluded(packet), 0) << at(a) << " " << at(b);
  }
  EXPECT_GE(midpoints, 10);
}

TEST(Elements, OfVisiblePointsNeverBelongToHiddenCorners) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 4, 4, {});
  const double x = 0.256;  // a block stands left of x
  builder.quad({{{x, 0, 0}, {x, 1, 0}, {x, 1, 1}, {x, 0, 1}}}, 4, 4, {});
  builder.quad({{{0, 1, 0}, {0, 1, 1}, {x, 1, 1}, {x, 1, 0}}}, 4, 4, {});
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}}}, 4, 4, {});
  const PatchSet& scene = builder.get();
  const RayScene ray_scene(scene);
  const DisplayMesh mesh = mesh_of(scene);
  std::vector<bool> hidden(std::size_t(mesh.elements), false);
  for (const auto& cell : mesh.cells)
    for (int k = 0; cell.children < 0 && cell.cut && k < 4; ++k)
      hidden[std::size_t(cell.leaf + k)] = mesh.vertices[cell.corners[k]].hidden;
  ASSERT_TRUE(std::find(hidden.begin(), hidden.end(), true) != hidden.end());
  const Elements elements(scene, ray_scene, mesh);
  for (const float beyond : {1e-4f, 5e-4f, 1.5e-3f})
    for (int k = 0; k < 1000; ++k) {
      const std::int32_t element = elements.at(0, (float(k) + 0.5f) / 1000, float(x) + beyond);
      ASSERT_GE(element, std::int32_t(scene.patches.size()));
      EXPECT_FALSE(hidden[std::size_t(element) - scene.patches.size()]) << k << " " << beyond;
    }
}

}  // namespace
}  // namespace patchlight
