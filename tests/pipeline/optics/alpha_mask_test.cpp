#include "pipeline/optics/intersect/alpha_mask.h"

#include <gtest/gtest.h>

#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/random.h"
#include "tests/alpha_mask_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// A unit square at each height, lit from above, with u along +x and v along -z.
PatchScene squares(const std::vector<double>& heights) {
  PatchScene builder;
  for (const double y : heights) builder.quad({{{0, y, 1}, {1, y, 1}, {1, y, 0}, {0, y, 0}}}, 1, 1, {});
  return builder;
}

/// A mask whose left half is a hole: alpha, bilinear between two texels, is 0.5 in the middle.
Texture right_half() {
  return {2, 1, {Texture::Wrap::clamp, Texture::Wrap::clamp}, false, {0, 255}};
}

/// The primitive that a vertical ray at (x,z) hits; -1: none.
std::int32_t hit_primitive(const RayScene& rays, double x, double z, bool down) {
  RayPacket packet;
  packet.clear();
  packet.set(3, rays.to_local({x, down ? 9.0 : -9.0, z}), Vec3f(0, down ? -1.0f : 1.0f, 0));
  rays.intersect(packet, false);
  return rays.hit(packet, 3).primitive;
}

bool is_occluded(const RayScene& rays, double x, bool down, float distance) {
  RayPacket packet;
  packet.clear();
  packet.set_shadow(7, rays.to_local({x, down ? 9.0 : -9.0, 0.5}), Vec3f(0, down ? -1.0f : 1.0f, 0), distance);
  return rays.occluded(packet) == 1u << 7;
}

TEST(AlphaMasks, RaysPassWhereTheMaskIsBelowTheCutoff) {
  PatchSet scene = squares({3, 2, 1, 0}).get();
  for (const int masked : {0, 1}) test::alpha_masked(scene, masked, right_half(), 0.5f);
  scene.materials[std::size_t(scene.primitives[1].material)].alpha_cutoff = 0.25f;  // passes from u = 0.375 on
  for (const RayScene::Tracer tracer : {RayScene::Tracer::embree, RayScene::Tracer::packets}) {
    const RayScene rays(scene, tracer);
    for (const auto& [x, first] : {std::pair(0.2, 2), {0.37, 2}, {0.38, 1}, {0.49, 1}, {0.51, 0}, {0.9, 0}}) {
      EXPECT_EQ(hit_primitive(rays, x, 0.5, true), first) << x;
      EXPECT_EQ(hit_primitive(rays, x, 0.5, false), 3) << x;
      EXPECT_EQ(is_occluded(rays, x, true, 6.5f), first == 0) << x;
      EXPECT_EQ(is_occluded(rays, x, true, 7.5f), first <= 1) << x;
      EXPECT_TRUE(is_occluded(rays, x, true, 8.5f)) << x;
    }
  }
}

TEST(AlphaMasks, LanesOfAPacketAreTestedIndividually) {
  PatchSet scene = squares({1, 0}).get();
  test::alpha_masked(scene, 0, test::checkers(16), 0.5f);
  const RayScene rays(scene);
  RayPacket packet;
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; lane += lane == 4 ? 2 : 1)
    packet.set(lane, rays.to_local({(lane + 0.5) / 16, 5, 0.99}), Vec3f(0, -1, 0));
  rays.intersect(packet, true);
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    EXPECT_EQ(rays.hit(packet, lane).primitive, lane == 5 ? -1 : lane % 2) << lane;
}

TEST(AlphaMasks, BothSidesHaveTheSameHoles) {
  PatchSet scene = squares({1}).get();
  Primitive back = scene.primitives[0];
  back.corners = {scene.primitives[0].corners[1], scene.primitives[0].corners[0], scene.primitives[0].corners[3],
                  scene.primitives[0].corners[2]};
  scene.primitives.push_back(back);
  test::make_sides(scene, 0, 1);
  scene.texcoords = {kIdentityTexcoords, {Vec2f(1, 0), Vec2f(0, 0), Vec2f(0, 1), Vec2f(1, 1)}};
  for (const int side : {0, 1}) test::alpha_masked(scene, side, right_half(), 0.5f);
  const RayScene rays(scene);
  for (const bool down : {true, false}) {
    EXPECT_EQ(hit_primitive(rays, 0.3, 0.5, down), -1);
    EXPECT_EQ(hit_primitive(rays, 0.7, 0.5, down), down ? 0 : 1);
  }
}

TEST(AlphaMasks, AlphaOfTextureMaterialAndVerticesIsMultiplied) {
  PatchSet scene = squares({0}).get();
  test::alpha_masked(scene, 0, {1, 1, {}, false, {204}}, 0.5f);  // 0.8
  Material& material = scene.materials[1];
  material.alpha = 0.9f;
  scene.colors = {{Vec4f(1, 1, 1, 0), Vec4f(1), Vec4f(1), Vec4f(1, 1, 1, 0)}};  // alpha = u
  EXPECT_FALSE(passes_alpha_test(scene, 0, 0.5 / 0.72 - 1e-4, 0.3));
  EXPECT_TRUE(passes_alpha_test(scene, 0, 0.5 / 0.72 + 1e-4, 0.3));
  material.alpha_cutoff = 0.72f + 1e-5f;
  EXPECT_FALSE(passes_alpha_test(scene, 0, 1, 0.3));
}

TEST(AlphaMasks, CoveredPointsAreUniformOverTheCoveredArea) {
  PatchSet scene = squares({0}).get();
  Texture quarter{4, 1, {}, true, {0, 0, 255, 0}};
  test::alpha_masked(scene, 0, quarter, 0.25f);
  const PatchSampler sampler(scene.primitives, scene.patches[0]);
  std::array<int, 8> counts{};  // in eighths of the covered area
  constexpr int kPoints = 8000;
  for (int k = 0; k < kPoints; ++k) {
    const Vec2f at =
        covered_point(scene, scene.patches[0], sampler, kronecker2(std::uint64_t(k), 1), hash64(std::uint64_t(k)));
    ASSERT_TRUE(at.x >= 0.5f && at.x < 0.75f && at.y >= 0 && at.y < 1);
    ++counts[std::size_t((at.x - 0.5f) * 16) * 2 + std::size_t(at.y * 2)];
  }
  double chi_square = 0;
  for (const int count : counts) chi_square += (count - 1000) * (count - 1000) / 1000.0;
  EXPECT_LT(chi_square, 24.3);  // 7 degrees of freedom, p = 0.001
}

TEST(AlphaMasks, CoveredPointIsAnyPointOfAnEmptyPatch) {
  PatchSet scene = squares({0}).get();
  test::alpha_masked(scene, 0, {1, 1, {}, true, {0}}, 1.0f / 1024);
  const PatchSampler sampler(scene.primitives, scene.patches[0]);
  const Vec2f at = covered_point(scene, scene.patches[0], sampler, {0.5f, 0.5f}, 7);
  EXPECT_TRUE(at.x >= 0 && at.x < 1 && at.y >= 0 && at.y < 1);
}

}  // namespace
}  // namespace patchlight
