#include "solver/display/display_solution.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "pipeline/optics/transport/elements.h"
#include "solver/display/display_mesh_builder.h"
#include "solver/form_factors/visible_area_fraction.h"
#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

DisplayMesh mesh_of(const PatchSet& scene) {
  const RayScene ray_scene(scene);
  std::int64_t cast = 0;
  return build_display_mesh(scene, ray_scene, PatchLookup(scene), 1, cast);
}

struct Solved {
  EnergyField energy;
  Transport transport;

  explicit Solved(const PatchSet& scene, int rays = 256, bool display = true) {
    SolveConfig config;
    config.rays = rays;
    config.tolerance = 1e-6;
    config.display = display;
    solve_again(scene, config);
  }

  void solve_again(const PatchSet& scene, const SolveConfig& config) {
    Progress progress({"test", true, ""});
    energy = solve(scene, config, transport, progress);
  }
};

/// A room whose ceiling is bright and which a wall divides, off the patches' edges; patches of x < 0.03 get no light.
PatchScene divided_room() {
  PatchScene builder;
  builder.room(1, 8, {0.5f, 0.0f});
  const int wall = builder.quad({{{0.03, -1, -1}, {0.03, 1, -1}, {0.03, 1, 1}, {0.03, -1, 1}}}, 8, 8, {0.5f, 0.0f});
  const int back = builder.quad({{{0.03, -1, -1}, {0.03, -1, 1}, {0.03, 1, 1}, {0.03, 1, -1}}}, 8, 8, {0.5f, 0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[wall].back = back;
  scene.primitives[back].back = wall;
  scene.primitives[1].light_group = 0;
  for (int i = 64; i < 128; ++i) scene.patches[i].emission = Color(1.0f);
  return builder;
}

TEST(DisplayMesh, CutsPatchesAlongCreasesAlone) {
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
    EXPECT_TRUE(mesh.vertices[k].patch >= 256 || mesh.vertices[k].patch % 16 > 0) << "the border is off the crease";
}

TEST(DisplayMesh, LeavesFillTheirPatches) {
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

TEST(DisplayMesh, LeavesFacetsOfCurvedMeshesWhole) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 4, {});
  builder.quad({{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}}, 4, 1, {});
  EXPECT_GE(mesh_of(builder.get()).roots[0], 0);
  builder.get().primitives[0].smooth_vertices = {0, 1, 2, 3};
  builder.get().primitives[1].smooth_vertices = {0, 3, 4, 5};
  EXPECT_EQ(mesh_of(builder.get()).cells.size(), 0u);
}

/// A drum of 16 facets about the y axis, from `low` to 2, in `rings` rings, above a floor at 0, each facet a patch.
PatchScene drum_above_a_floor(double low, int rings, int floor_cells = 32) {
  constexpr int kAround = 16;
  PatchScene builder;
  builder.quad({{{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}}}, floor_cells, floor_cells, {0.8f, 0.0f});
  const auto at = [](int k, double y) {
    return Vec3d(std::cos(2 * kPi * k / kAround), y, -std::sin(2 * kPi * k / kAround));
  };
  for (int j = 0; j < rings; ++j) {
    const double y0 = low + (2 - low) * j / rings, y1 = low + (2 - low) * (j + 1) / rings;
    for (int k = 0; k < kAround; ++k) {
      const int facet = builder.quad({{at(k, y0), at(k + 1, y0), at(k + 1, y1), at(k, y1)}}, 1, 1, {0.5f, 0.0f});
      const int next = (k + 1) % kAround;
      builder.get().primitives[facet].smooth_vertices = {kAround * j + k, kAround * j + next, kAround * (j + 1) + next,
                                                         kAround * (j + 1) + k};
    }
  }
  return builder;
}

TEST(DisplayMesh, GivesFacetsNearOtherSurfacesVerticesOfTheirOwn) {
  const PatchScene near = drum_above_a_floor(0, 8), far = drum_above_a_floor(1.9, 1);
  EXPECT_EQ(mesh_of(PatchScene(far).get()).facets.size(), 0u);
  const DisplayMesh mesh = mesh_of(PatchScene(near).get());
  ASSERT_GE(mesh.facets.size(), 32u) << "the lowest ring, and the one above it that has its vertices too";
  ASSERT_LT(mesh.facets.size(), 128u);
  const DisplayMesh::Facet &first = mesh.facets[0], &second = mesh.facets[1];
  EXPECT_EQ(first.patch, 1024);
  EXPECT_EQ(first.corners[1], second.corners[0]) << "neighbours share vertices";
  EXPECT_EQ(first.corners[3], second.corners[2]);
  for (const auto& facet : mesh.facets)
    for (const std::int32_t corner : facet.corners) EXPECT_LT(corner, mesh.gathered);
}

TEST(DisplaySolution, AtTheFootOfACurvedMeshIsNearerToTheTruthThanFacets) {
  const auto under_a_sky = [](int rings, int floor_cells) {
    PatchScene builder = drum_above_a_floor(0, rings, floor_cells);
    const int sky = builder.quad({{{-40, 20, -40}, {40, 20, -40}, {40, 20, 40}, {-40, 20, 40}}}, 1, 1, {0.0f, 1.0f});
    builder.get().primitives[sky].light_group = 0;
    return builder;
  };
  const auto vertices_at_foot = [](const EnergyField& energy) {
    double sum = 0;
    for (std::size_t i = 0; i < 16; ++i) sum += energy.groups[0].display[energy.display->facets[i].corners[0]].y / 16;
    return sum;
  };
  const Solved coarse(under_a_sky(8, 32).get(), 1024);
  const double truth = vertices_at_foot(Solved(under_a_sky(32, 128).get(), 256).energy);
  double facets = 0;
  for (int i = 0; i < 16; ++i) facets += coarse.energy.groups[0].indirect[32 * 32 + i].y / 16;
  EXPECT_GT(facets / truth, 1.1);
  EXPECT_NEAR(vertices_at_foot(coarse.energy) / truth, 1, 0.06);
}

/// A floor of one square metre, seen from +y, and the sides and top of a block on it from (x0,z0) to (x1,z1).
float visible_floor(double x0, double x1, double z0, double z1, std::uint64_t random) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 1, 1, {});
  builder.quad({{{x1, 0, z0}, {x1, 1, z0}, {x1, 1, z1}, {x1, 0, z1}}}, 1, 1, {});
  builder.quad({{{x0, 1, z0}, {x0, 1, z1}, {x1, 1, z1}, {x1, 1, z0}}}, 1, 1, {});
  builder.quad({{{x0, 0, z1}, {x1, 0, z1}, {x1, 1, z1}, {x0, 1, z1}}}, 1, 1, {});
  builder.quad({{{x0, 0, z0}, {x0, 1, z0}, {x1, 1, z0}, {x1, 0, z0}}}, 1, 1, {});
  builder.quad({{{x0, 0, z0}, {x0, 0, z1}, {x0, 1, z1}, {x0, 1, z0}}}, 1, 1, {});
  const RayScene ray_scene(builder.get());
  std::int64_t cast = 0;
  for (std::size_t i = 1; i < 6; ++i)
    EXPECT_EQ(visible_area_fraction(builder.get(), ray_scene, builder.get().patches[i], 1024, random, cast), 1.0f);
  return visible_area_fraction(builder.get(), ray_scene, builder.get().patches[0], 1024, random, cast);
}

TEST(DisplayMesh, LeavesBesideAPanelAskNoVertexAtItsEdge) {
  PatchScene builder;
  builder.room(1, 8, {});  // the panel stands 1 cm before the wall at z = -1
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

TEST(Elements, HaveNoHiddenCornersStandForWhatIsExposed) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 4, 4, {});
  const double x = 0.256;  // a block stands on what is left of it
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

TEST(ExposedPart, IsWhatNothingStandsOn) {
  for (std::uint64_t random = 0; random < 8; ++random) {
    EXPECT_NEAR(visible_floor(-1, 0.3, 0, 1, random), 0.7, 0.01) << "one border";
    EXPECT_NEAR(visible_floor(-1, 0.3, -1, 0.6, random), 1 - 0.3 * 0.6, 0.025) << "a corner";
    EXPECT_NEAR(visible_floor(0.3, 0.7, 0.2, 0.7, random), 1 - 0.4 * 0.5, 0.03) << "in the middle";
    EXPECT_EQ(visible_floor(1.5, 1.7, 0.2, 0.7, random), 1.0f) << "beside it";
  }
}

TEST(DisplaySolution, IsExactInAFurnace) {
  PatchScene builder;
  builder.room(1, 6, {0.8f, 1.0f});
  const Solved solved(builder.get(), 64);
  ASSERT_GT(solved.energy.display->gathered, 100);
  for (const Color& h : solved.energy.groups[0].display)
    EXPECT_NEAR(h.y, 4.0, 4e-3) << "five, but for the direct light";
}

TEST(DisplaySolution, IsNearerToTheTruthThanPatchesAtCreases) {
  const auto room = [](int cells) {
    PatchScene builder;
    builder.room(1, cells, {0.7f, 0.0f});
    builder.quad({{{-0.3, 0.9, -0.3}, {0.3, 0.9, -0.3}, {0.3, 0.9, 0.3}, {-0.3, 0.9, 0.3}}}, 1, 1, {0.0f, 20.0f});
    return builder;
  };
  PatchScene coarse = room(6), fine = room(96);
  const Solved solved(coarse.get(), 4096), truth(fine.get(), 256, false);
  const PatchLookup at(fine.get());
  double by_display = 0, by_patches = 0;
  const EnergyField::Group& group = solved.energy.groups[0];
  for (std::size_t k = 0; k < group.display.size(); ++k) {
    const DisplayMesh::Vertex& vertex = solved.energy.display->vertices[k];
    const std::int32_t wall = coarse.get().patches[vertex.patch].primitive;
    if (wall != 2) continue;  // the floor
    const float there = truth.energy.groups[0].indirect[at.patch(wall, vertex.u, vertex.v)].y;
    by_display += std::pow(group.display[k].y / there - 1, 2);
    by_patches += std::pow(group.indirect[vertex.patch].y / there - 1, 2);
  }
  EXPECT_LT(by_display, 0.1 * by_patches);
}

/// Patches that the wall stands across belong to both sides, so that some of their light is seen behind it.
TEST(DisplaySolution, BringsHardlyAnyLightBehindAWall) {
  PatchScene builder = divided_room();
  const Solved solved(builder.get());
  const EnergyField::Group& group = solved.energy.groups[0];
  float most = 0;
  for (const Color& h : group.display) most = std::max(most, h.y);
  int dark = 0;
  for (std::size_t k = 0; k < group.display.size(); ++k) {
    const DisplayMesh::Vertex& v = solved.energy.display->vertices[k];
    const PatchSet& scene = builder.get();
    const Vec3d at = point_at(scene.primitives[scene.patches[v.patch].primitive], v.u, v.v).position;
    if (at.x > 0.03 || scene.patches[v.patch].normal.x > 0.5f) continue;
    if (at.x == 0.03) continue;  // the wall itself
    EXPECT_LT(group.display[k].y, 0.025f * most) << at.x;
    ++dark;
  }
  EXPECT_GT(dark, 100);
}

TEST(DisplaySolution, NeedsNoRayForOtherColours) {
  PatchScene builder = divided_room();
  PatchSet& scene = builder.get();
  SolveConfig config;
  config.rays = 64;
  config.tolerance = 1e-6;
  Solved solved(scene, 64);
  const std::vector<Color> first = solved.energy.groups[0].display;
  EXPECT_GT(solved.energy.rays, 0);
  for (Patch& patch : scene.patches) patch.reflectance = Color(0.0f);
  solved.solve_again(scene, config);
  EXPECT_EQ(solved.energy.rays, 0);
  for (const Color& h : solved.energy.groups[0].display) EXPECT_EQ(h.y, 0) << "nothing reflects";
  for (Patch& patch : scene.patches) patch.reflectance = Color(0.5f);
  solved.solve_again(scene, config);
  EXPECT_EQ(solved.energy.groups[0].display, first);
}

TEST(DisplaySolution, FollowsEveryPairOfMethods) {
  PatchScene builder;
  builder.room(1, 6, {0.6f, 0.0f});
  builder.quad({{{-0.3, 0.9, -0.3}, {0.3, 0.9, -0.3}, {0.3, 0.9, 0.3}, {-0.3, 0.9, 0.3}}}, 1, 1, {0.0f, 20.0f});
  const Solved usual(builder.get(), 1024);
  for (const auto& [method, form_factors] :
       {std::pair("matrix", "hemicube"), {"progressive", "rays"}, {"progressive", "hemicube"}}) {
    SolveConfig config;
    config.method = method;
    config.form_factors = form_factors;
    config.rays = 1024;
    Solved other(builder.get(), 32);
    other.transport = {};
    other.solve_again(builder.get(), config);
    double difference = 0, norm = 0;
    ASSERT_EQ(other.energy.groups[0].display.size(), usual.energy.groups[0].display.size());
    for (std::size_t k = 0; k < usual.energy.groups[0].display.size(); ++k) {
      const float h = usual.energy.groups[0].display[k].y;
      difference += std::pow(other.energy.groups[0].display[k].y - h, 2);
      norm += h * h;
    }
    EXPECT_LT(std::sqrt(difference / norm), 0.03) << method << " over " << form_factors;
  }
}

TEST(DisplaySolution, GivesTheSameBitsForAnyNumberOfThreads) {
  PatchScene builder = divided_room();
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return Solved(builder.get(), 64).energy.groups[0].display;
  };
  EXPECT_EQ(with_threads(1), with_threads(4));
}

}  // namespace
}  // namespace patchlight
