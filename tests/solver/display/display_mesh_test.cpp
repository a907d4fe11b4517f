#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/transport/face_lookup.h"
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

TEST(DisplayMesh, DoesNotRefineBelowTheSizeOfAScale) {
  PatchScene builder;
  builder.room(1, 8, {});
  builder.quad({{{0, -0.98, 0}, {0.1, -0.98, 0}, {0.1, -0.98, 0.1}, {0, -0.98, 0.1}}}, 1, 1, {});  // faces the floor
  PatchSet& scene = builder.get();
  const std::size_t faces = mesh_of(scene).faces.size();
  scene.primitives[6].patch_area = 1;  // of which it is a hundredth
  const DisplayMesh mesh = mesh_of(scene);
  EXPECT_LT(mesh.faces.size(), faces);
  ASSERT_GE(mesh.roots.back(), 0);
  EXPECT_LT(mesh.cells[mesh.roots.back()].children, 0);
}

TEST(DisplayMesh, FacesCoverTheirPatches) {
  PatchScene builder = divided_room();
  builder.sphere({0.5, -0.8, 0.3}, 0.2, 8, 12, {});
  const PatchSet& scene = builder.get();
  const DisplayMesh mesh = mesh_of(scene);
  const std::vector<Patch> faces = face_patches(scene, mesh);
  const FaceLookup lookup(scene, mesh);
  std::vector<double> hits(faces.size());
  double area = 0, whole = 0;
  for (std::size_t i = 0; i < mesh.roots.size(); ++i) {
    if (mesh.roots[i] < 0) continue;
    const Patch& patch = scene.patches[i];
    whole += patch.area;
    for (float x = 0.03f; x < 1; x += 0.06f)
      for (float y = 0.03f; y < 1; y += 0.06f) {
        const float u = patch.u0 + x * (patch.u1 - patch.u0), v = patch.v0 + y * (patch.v1 - patch.v0);
        const FaceLookup::Place place = lookup.find(std::int32_t(i), u, v);
        ASSERT_GE(place.face, 0);
        const Patch& face = faces[place.face];
        hits[place.face] += patch.area / (17 * 17);
        ASSERT_TRUE(face.u0 <= u && u <= face.u1 && face.v0 <= v && v <= face.v1);
        ASSERT_NEAR(face.u0 + place.u * (face.u1 - face.u0), u, 1e-5);
      }
  }
  double difference = 0, cut = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    area += faces[f].area;
    difference += std::abs(hits[f] - faces[f].area);
    cut += faces[f].triangles.empty() ? 0 : faces[f].area;
    EXPECT_NEAR(faces[f].normal.length(), 1, 1e-5);
    EXPECT_NEAR(mesh.faces[f].part, faces[f].area / scene.patches[mesh.faces[f].patch].area, 1e-6);
  }
  EXPECT_NEAR(area, whole, 1e-6 * whole);
  EXPECT_LT(difference, 0.2 * whole) << "points fall on the faces that they lie on";
  EXPECT_GT(cut, 0);
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
    for (const std::int32_t corner : facet.corners)
      EXPECT_LT(corner, std::int64_t(mesh.vertices.size() + mesh.blends.size()));
}

TEST(DisplayMesh, IsAsFineBesideASmallThingOnAnyGround) {
  for (const double ground : {2.0, 30.0, 1000.0}) {
    PatchScene builder;
    const double h = ground / 2;
    builder.quad({{{-h, 0, -h}, {-h, 0, h}, {h, 0, h}, {h, 0, -h}}}, 40, 40, {});
    const std::array<Vec2f, 5> foot{Vec2f(-0.15f, 0), {0.15f, 0}, {0.15f, -0.3f}, {-0.15f, -0.3f}, {-0.15f, 0}};
    for (int k = 0; k < 4; ++k) {
      const Vec3d a(foot[k].x, 0, foot[k].y), b(foot[k + 1].x, 0, foot[k + 1].y), up(0, 0.3, 0);
      builder.quad({{a, b, b + up, a + up}}, 4, 4, {});
    }
    const PatchSet& scene = builder.get();
    const DisplayMesh mesh = mesh_of(scene);
    const FaceLookup lookup(scene, mesh);
    const PatchLookup patches(scene);
    const std::vector<Patch> faces = face_patches(scene, mesh);
    for (const double distance : {0.002, 0.05, 0.2}) {
      const auto u = float((distance + h) / ground), v = 0.5f;  // u runs along z, v along x
      const std::int32_t patch = patches.patch(0, u, v), face = lookup.find(patch, u, v).face;
      const double area = face < 0 ? scene.patches[patch].area : faces[face].area;
      EXPECT_LT(std::sqrt(area), 0.025 + 0.7 * distance) << ground << " " << distance;
    }
    EXPECT_LT(mesh.gathered, 6000) << ground;
  }
}

/// Number of pairs of corners of a face, or of ends of a hanging vertex's edge, between which a surface stands.
int parted_pairs(const PatchSet& scene, const DisplayMesh& mesh, std::int32_t primitive) {
  const RayScene ray_scene(scene);
  const auto is_parted = [&](std::int32_t a, std::int32_t b) {
    const auto above = [&](std::int32_t i) {
      const SurfacePoint at = point_at(scene.primitives[primitive], mesh.vertices[i].u, mesh.vertices[i].v);
      return at.position + Vec3d(at.normal) * 1e-4;
    };
    const Vec3f across(above(b) - above(a));
    if (across.length() == 0) return false;
    RayPacket packet;
    packet.clear();
    packet.set_shadow(0, ray_scene.to_local(above(a)), across.normalized(), across.length());
    return ray_scene.occluded(packet) != 0;
  };
  int count = 0;
  for (const DisplayMesh::Face& face : mesh.faces) {
    if (scene.patches[face.patch].primitive != primitive) continue;
    for (const std::int32_t a : mesh.corners_of(face))
      for (const std::int32_t b : mesh.corners_of(face)) count += a < b && is_parted(a, b);
  }
  for (const auto& [a, b] : mesh.midpoints)
    count += scene.patches[mesh.vertices[a].patch].primitive == primitive && is_parted(a, b);
  return count;
}

TEST(DisplayMesh, NoFaceLiesOnBothSidesOfAWall) {
  PatchScene builder = divided_room();
  const DisplayMesh mesh = mesh_of(builder.get());
  for (int wall = 2; wall < 6; ++wall) EXPECT_EQ(parted_pairs(builder.get(), mesh, wall), 0) << wall;
  const auto is_cut = [](const auto& cell) { return cell.cut >= 0; };
  EXPECT_GE(std::count_if(mesh.cells.begin(), mesh.cells.end(), is_cut), 4 * 16);
}

TEST(DisplayMesh, HangingVerticesLieBetweenEarlierOnesAtTheTipOfATriangle) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 2}, {2, 0, 1}, {2, 0, 1}}}, 8, 8, {});  // u along z, the tip at v = 1
  builder.quad({{{1.1, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1.1, 1, 1}}}, 8, 8, {});
  const PatchSet& scene = builder.get();
  const DisplayMesh mesh = mesh_of(scene);
  const auto first = std::int32_t(mesh.vertices.size() - mesh.midpoints.size());
  EXPECT_GT(mesh.midpoints.size(), 0u);
  for (std::size_t k = 0; k < mesh.midpoints.size(); ++k)
    for (const std::int32_t end : mesh.midpoints[k]) EXPECT_LT(end, first + std::int32_t(k));
}

TEST(DisplayMesh, NoVertexGathersLightInsideOfAClosedBody) {
  PatchScene builder;
  builder.quad({{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}}, 16, 16, {});
  builder.quad({{{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}}}, 16, 16, {});
  const std::array<Vec2f, 5> foot{Vec2f(-0.5f, 0.5f), {0.5f, 0.5f}, {0.5f, -0.5f}, {-0.5f, -0.5f}, {-0.5f, 0.5f}};
  for (int k = 0; k < 4; ++k) {
    const Vec3d a(foot[k].x, -0.1, foot[k].y), b(foot[k + 1].x, -0.1, foot[k + 1].y), up(0, 0.6, 0);
    builder.quad({{a, b, b + up, a + up}}, 8, 8, {});
  }
  builder.quad({{{-0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.5, 0.5, -0.5}, {-0.5, 0.5, -0.5}}}, 8, 8, {});
  const PatchSet& scene = builder.get();
  const DisplayMesh mesh = mesh_of(scene);
  int inside = 0, outside = 0;
  for (const auto& vertex : std::span(mesh.vertices).first(mesh.gathered)) {
    const std::int32_t i = scene.patches[vertex.patch].primitive;
    const Vec3d at = position_at(scene.primitives[i].corners, vertex.u, vertex.v);
    if (i == 0) ++(std::max(std::abs(at.x), std::abs(at.z)) < 0.5 ? inside : outside);
  }
  EXPECT_EQ(inside, 0);
  EXPECT_GT(outside, 100);
}

TEST(DisplayMesh, NoFaceLiesOnBothSidesOfAPanelsEdge) {
  PatchScene builder;
  builder.room(1, 8, {});  // the panel is 5 mm in front of the wall at z = -1
  builder.quad({{{-0.55, -0.5, -0.995}, {0.5, -0.5, -0.995}, {0.5, 0.5, -0.995}, {-0.55, 0.5, -0.995}}}, 4, 4, {});
  const DisplayMesh mesh = mesh_of(builder.get());
  constexpr std::int32_t kWall = 4;
  const PatchSet& scene = builder.get();
  const auto is_covered = [&](std::int32_t i) {
    const Vec3d at = point_at(scene.primitives[kWall], mesh.vertices[i].u, mesh.vertices[i].v).position;
    return at.x > -0.55 && at.x < 0.5 && std::abs(at.y) < 0.5;
  };
  int covered = 0, open = 0;
  for (const DisplayMesh::Face& face : mesh.faces) {
    if (scene.patches[face.patch].primitive != kWall) continue;
    const auto corners = mesh.corners_of(face);
    const auto count = std::count_if(corners.begin(), corners.end(), is_covered);
    EXPECT_TRUE(count == 0 || count == face.count) << count << " of " << face.count;
    ++(count == 0 ? open : covered);
  }
  EXPECT_GE(covered, 16);
  EXPECT_GE(open, 16);
}

TEST(DisplayMesh, FacesBesideASheetOnTheirEdgesDoNotShareVertices) {
  PatchScene builder;
  builder.quad({{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}}, 8, 8, {});
  builder.quad({{{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}}}, 4, 4, {});
  builder.quad({{{0, -1, 1}, {0, 1, 1}, {0, 1, -1}, {0, -1, -1}}}, 4, 4, {});
  test::make_sides(builder.get(), 1, 2);
  const DisplayMesh mesh = mesh_of(builder.get());
  EXPECT_EQ(parted_pairs(builder.get(), mesh, 0), 0);
  int near = 0;
  for (std::int32_t k = 0; k < mesh.gathered; ++k) {
    if (builder.get().patches[mesh.vertices[k].patch].primitive != 0) continue;
    const double x = point_at(builder.get().primitives[0], mesh.vertices[k].u, mesh.vertices[k].v).position.x;
    EXPECT_GT(std::abs(x), 1e-4) << "on its side of the sheet";
    near += std::abs(x) < 0.01;
  }
  EXPECT_GE(near, 32) << "on both sides of it";
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
  const DisplayMesh mesh = mesh_of(builder.get());
  EXPECT_GE(mesh.midpoints.size(), 10u);
  EXPECT_EQ(parted_pairs(builder.get(), mesh, 0), 0);
}

}  // namespace
}  // namespace patchlight
