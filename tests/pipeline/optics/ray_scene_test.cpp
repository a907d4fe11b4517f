#include "pipeline/optics/intersect/ray_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

SurfaceHit cast(const RayScene& rays, const Vec3d& from, const Vec3d& to) {
  RayPacket packet;
  packet.clear();
  packet.set(5, rays.to_local(from), Vec3f((to - from).normalized()));
  rays.intersect(packet, false);
  return rays.hit(packet, 5);
}

/// Casts rays to known (u,v): the hit's (u,v) must be those of the same point.
void expect_uv(const PatchSet& scene, double tolerance) {
  const RayScene rays(scene);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.02, 0.98);
  for (int k = 0; k < 1000; ++k) {
    const double u = unit(random), v = unit(random);
    const SurfacePoint point = point_at(scene.primitives[0], u, v);
    const SurfaceHit hit = cast(rays, point.position + Vec3d(point.normal) * 0.3, point.position);
    ASSERT_EQ(hit.primitive, 0);
    EXPECT_TRUE(hit.front);
    EXPECT_LT((point_at(scene.primitives[0], hit.u, hit.v).position - point.position).length(), tolerance);
  }
}

TEST(RayScene, FindsBilinearCoordinatesOfAnyConvexQuad) {
  const std::vector<std::array<Vec3d, 4>> shapes{
      {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}},           // square
      {{{0, 0, 0}, {2, 0, 0}, {2.5, 1, 0}, {0.5, 1, 0}}},       // parallelogram
      {{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {0, 1, 0}}},           // trapezoid
      {{{0, 0, 0}, {1, 0, 0}, {1.7, 1.3, 0}, {-0.2, 0.8, 0}}},  // general
      {{{0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, {0.2, 1, 0}}},       // triangle
  };
  for (const auto& corners : shapes) {
    PatchScene builder;
    builder.quad(corners, 1, 1, {});
    expect_uv(builder.get(), 5e-6);
  }
}

TEST(RayScene, DoesNotHitTheQuadOnWhichARayStarts) {
  // Two triangles of a fan of 24: the plane by the short edges, which meet at a flat angle, would be far off at the
  // centre. In single precision, as files have it, of all orientations, beside a large scene's other end.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 200; ++k) {
    const Vec3d x = Vec3d(unit(random), unit(random), unit(random)).normalized();
    const Vec3d y = (x % Vec3d(unit(random), unit(random), unit(random))).normalized();
    const Vec3d center(10 * unit(random), 10 * unit(random), 10 * unit(random));
    std::array<Vec3d, 4> kite{center, center, center, center};
    for (const auto& [corner, step] : {std::pair(3, -1), {0, 0}, {1, 1}})
      kite[corner] += (x * std::cos(step * kPi / 12) + y * std::sin(step * kPi / 12)) * 0.017;
    for (Vec3d& corner : kite) corner = Vec3d(Vec3f(corner));
    PatchScene builder;
    builder.quad({kite[1], kite[2], kite[3], kite[0]}, 1, 1, {});
    builder.quad({{{0, 0, 20}, {0, 1, 20}, {1, 1, 20}, {1, 0, 20}}}, 1, 1, {});
    std::rotate(builder.get().primitives[0].corners.begin(), builder.get().primitives[0].corners.begin() + k % 4,
                builder.get().primitives[0].corners.end());
    const RayScene rays(builder.get());
    for (const double u : {0.05, 0.5, 0.9})
      for (const double v : {0.1, 0.5, 0.95}) {
        const SurfacePoint point = point_at(builder.get().primitives[0], u, v);
        const Vec3d from = point.position + Vec3d(point.normal) * double(rays.offset(0));
        for (const Vec3d& aside : {Vec3d(0.0), x * 0.5, y * 2.0})
          ASSERT_NE(cast(rays, from, from + Vec3d(point.normal) + aside).primitive, 0) << k << " " << u << " " << v;
      }
  }
}

TEST(RayScene, FindsCoordinatesOnSpheresFromOutsideAndInside) {
  for (const double radius : {0.5, -0.5}) {
    PatchScene builder;
    builder.sphere({3, 1, 2}, radius, 4, 6, {});
    expect_uv(builder.get(), 5e-6);
  }
}

TEST(RayScene, TellsFrontFromBack) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  builder.sphere({5, 0, 0}, 1, 4, 6, {});
  const RayScene rays(builder.get());
  EXPECT_TRUE(cast(rays, {0.5, 0.5, 1}, {0.5, 0.5, 0}).front);
  EXPECT_FALSE(cast(rays, {0.5, 0.5, -1}, {0.5, 0.5, 0}).front);
  EXPECT_TRUE(cast(rays, {3, 0, 0}, {5, 0, 0}).front);
  EXPECT_FALSE(cast(rays, {5, 0, 0}, {6, 0, 0}).front);
  EXPECT_EQ(cast(rays, {0.5, 0.5, 1}, {0.5, 0.5, 2}).primitive, -1);
}

TEST(RayScene, ResolvesTheSideOfATwoSidedSurface) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 4, 1, {});
  builder.quad({{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 1, 0}}}, 4, 1, {});
  PatchSet& scene = builder.get();
  scene.primitives[0].back = 1;
  scene.primitives[1].back = 0;
  const RayScene rays(scene);
  const SurfaceHit front = cast(rays, {0.1, 0.5, 1}, {0.1, 0.5, 0}), back = cast(rays, {0.1, 0.5, -1}, {0.1, 0.5, 0});
  EXPECT_EQ(front.primitive, 0);
  EXPECT_NEAR(front.u, 0.1, 1e-6);
  EXPECT_EQ(back.primitive, 1);
  EXPECT_TRUE(back.front);
  EXPECT_NEAR(back.u, 0.9, 1e-6);
}

TEST(PatchLookup, FindsThePatchThatContainsUv) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 7, 5, {});
  builder.sphere({0, 0, 0}, 1, 9, 11, {});
  const PatchSet& scene = builder.get();
  const PatchLookup lookup(scene);
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& p = scene.patches[i];
    EXPECT_EQ(lookup.patch(p.primitive, 0.5f * (p.u0 + p.u1), 0.5f * (p.v0 + p.v1)), std::int32_t(i));
  }
  EXPECT_EQ(lookup.patch(0, 1.0f, 1.0f), 34);
  EXPECT_EQ(lookup.patch(0, 0.0f, 0.0f), 0);
}

TEST(RayScene, OffsetAvoidsSelfIntersectionOfABentQuad) {
  for (const RayScene::Tracer tracer : {RayScene::Tracer::packets, RayScene::Tracer::embree})
    for (const double bend : {-1e-3, 1e-3}) {
      test::PatchScene builder;
      builder.quad({{{0, 0, 0}, {1, 0, bend}, {1, 1, 0}, {0, 1, bend}}}, 1, 1, {});
      const RayScene ray_scene(builder.get(), tracer);
      EXPECT_LT(ray_scene.offset(0), 1e-3f);
      RayPacket packet;
      for (int k = 0; k < 100; ++k) {
        packet.clear();
        const double u = (k % 10 + 0.5) / 10, v = (k / 10 + 0.5) / 10;
        const SurfacePoint point = point_at(builder.get().primitives[0], u, v);
        const Vec3f start = ray_scene.to_local(point.position) + point.normal * ray_scene.offset(0);
        packet.set_shadow(0, start, point.normal, 10.0f);
        EXPECT_EQ(ray_scene.occluded(packet), 0u) << u << " " << v << " " << bend;
      }
    }
}

}  // namespace
}  // namespace patchlight
