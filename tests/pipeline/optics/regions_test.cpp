#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/optics/cuts/crossings.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "tests/patch_scene.h"

namespace patchlight::test {
namespace {

/// A plate from -1 to 1 at y = 0 that faces up, of 8 x 8 cells, with a square hole from -0.4 to 0.4, and its back.
PatchSet plate() {
  Region region;
  constexpr std::array<Vec2d, 4> kOuter{Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1)};
  std::array<Vec2d, 4> inner;
  for (std::size_t k = 0; k < 4; ++k) inner[k] = Vec2d(0.5, 0.5) + (kOuter[k] - Vec2d(0.5, 0.5)) * 0.4;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    region.pieces.push_back({kOuter[k], kOuter[next], inner[next], inner[k]});
    region.edges.push_back({kOuter[k], kOuter[next]});
    region.edges.push_back({inner[next], inner[k]});
  }
  PatchScene builder;
  builder.quad({{{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}}, 8, 8, {});
  builder.quad({{{1, 0, 1}, {-1, 0, 1}, {-1, 0, -1}, {1, 0, -1}}}, 8, 8, {});
  PatchSet& scene = builder.get();
  scene.primitives[0].region = std::make_shared<const Region>(region);
  scene.primitives[1].region = std::make_shared<const Region>(region.mirrored());
  scene.primitives[0].back = 1;
  scene.primitives[1].back = 0;
  std::erase_if(scene.patches, [](const Patch& p) {
    return std::abs(p.center.x) < 0.25 && std::abs(p.center.z) < 0.25;  // wholly in the hole
  });
  set_triangles(scene);
  return std::move(scene);
}

TEST(Regions, RaysHitThemAndPassThroughTheirHoles) {
  const PatchSet scene = plate();
  for (const RayScene::Tracer tracer : {RayScene::Tracer::packets, RayScene::Tracer::embree}) {
    const RayScene rays(scene, tracer);
    for (const bool from_above : {true, false})
      for (double x = -0.97; x < 1; x += 0.1)
        for (double z = -0.95; z < 1; z += 0.1) {
          RayPacket packet;
          packet.clear();
          packet.set(0, rays.to_local({x - 0.2, from_above ? 1.0 : -1.0, z + 0.1}),
                     {0.2f, from_above ? -1.0f : 1.0f, -0.1f});
          rays.intersect(packet, false);
          const SurfaceHit hit = rays.hit(packet, 0);
          if (std::abs(x) < 0.4 && std::abs(z) < 0.4) {
            EXPECT_LT(hit.primitive, 0) << x << ' ' << z;
            continue;
          }
          ASSERT_EQ(hit.primitive, from_above ? 0 : 1) << x << ' ' << z;
          const Vec3d at = position_at(scene.primitives[hit.primitive].corners, hit.u, hit.v);
          EXPECT_LT((at - Vec3d(x, 0, z)).length(), 1e-5);
        }
  }
}

TEST(Regions, LookupFindsThePatchOrOneNearTheHole) {
  const PatchSet scene = plate();
  const PatchLookup lookup(scene);
  ASSERT_EQ(lookup.rows(0), 8);
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 8; ++column) {
      const std::int32_t patch = lookup.at(lookup.row(0, row), column);
      const std::int32_t found = lookup.patch(0, (float(column) + 0.5f) / 8, (float(row) + 0.5f) / 8);
      const bool in_hole = row >= 3 && row <= 4 && column >= 3 && column <= 4;
      EXPECT_EQ(patch < 0, in_hole);
      ASSERT_GE(found, 0);
      EXPECT_TRUE(in_hole || found == patch);
      const Patch& p = scene.patches[found];
      EXPECT_LE(std::abs(8 * p.u0 - float(column)) + std::abs(8 * p.v0 - float(row)), in_hole ? 1.01f : 0.01f);
    }
}

/// A gable at x = 0, from `low` up to 1 m higher, in two pieces, that faces +X.
Primitive gable(double low) {
  Region region;
  region.pieces = {{{{0, 0}, {1, 0}, {1, 0.5}, {0, 0.5}}}, {{{0, 0.5}, {1, 0.5}, {0.5, 1}, {0.5, 1}}}};
  region.edges = {
      {{{0, 0}, {1, 0}}}, {{{1, 0}, {1, 0.5}}}, {{{1, 0.5}, {0.5, 1}}}, {{{0.5, 1}, {0, 0.5}}}, {{{0, 0.5}, {0, 0}}}};
  Primitive gable;
  gable.corners = {{{0, low, 0.5}, {0, low, -0.5}, {0, low + 1, -0.5}, {0, low + 1, 0.5}}};
  gable.region = std::make_shared<const Region>(region);
  return gable;
}

TEST(Regions, StandOnOthersByTheirOutlinesAndCrossThemByTheirPieces) {
  Primitive floor = plate().primitives[0];
  floor.region.reset();
  for (const auto& [low, height] : {std::pair(0.0, 0.0), {0.05, 0.05}, {-0.5, 0.0}, {-0.6, 0.0}, {-0.3, 0.0}}) {
    const auto crossings = find_crossings({floor, gable(low)}, [](std::int32_t i) { return i == 0 ? 0.1 : -1.0; })[0];
    double length = 0;
    for (const Crossing& crossing : crossings) {
      EXPECT_NEAR(crossing.height, height, 1e-9);
      EXPECT_NEAR(crossing.relief, low + 1, 1e-9);
      length += (crossing.to - crossing.from).length();
    }
    EXPECT_NEAR(length, low < -0.5 ? 0.8 : 1, 1e-6) << low;
  }
}

TEST(Regions, PatchesAreSampledWhereTheyAre) {
  const PatchSet scene = plate();
  double area = 0;
  for (const Patch& patch : scene.patches) {
    const PatchSampler sampler(scene.primitives, patch);
    for (int k = 0; k < 64; ++k) {
      const Vec3d at = sampler(float(k % 8) / 8 + 0.06f, float(k / 8) / 8 + 0.06f).position;
      EXPECT_TRUE(std::abs(at.x) > 0.4 - 1e-9 || std::abs(at.z) > 0.4 - 1e-9);
    }
    double of_triangles = 0;
    for (std::size_t k = 0; k < patch.triangles.size(); k += 3)
      of_triangles +=
          0.5 *
          ((patch.triangles[k + 1] - patch.triangles[k]) % (patch.triangles[k + 2] - patch.triangles[k])).length();
    area += patch.triangles.empty() ? patch.area : of_triangles;
  }
  EXPECT_NEAR(area, 2 * (4 - 0.64), 1e-9);
}

}  // namespace
}  // namespace patchlight::test
