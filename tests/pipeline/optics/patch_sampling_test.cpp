#include "pipeline/optics/sampling/patch_sampling.h"

#include <gtest/gtest.h>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

/// Mean of the sampled positions over a fine regular grid of the unit square.
Vec3d sampled_centroid(const Primitive& primitive, const Patch& patch) {
  const std::vector<Primitive> primitives{primitive};
  const PatchSampler sample(primitives, patch);
  Vec3d sum(0.0);
  constexpr int kSide = 256;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) sum += sample((float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide).position;
  return sum / (kSide * kSide);
}

TEST(PatchSampling, IsUniformOverATriangle) {
  test::PatchScene builder;
  builder.quad({{{0, 0, 0}, {3, 0, 0}, {0, 6, 0}, {0, 6, 0}}}, 1, 1, {});
  const Vec3d centroid = sampled_centroid(builder.get().primitives[0], builder.get().patches[0]);
  EXPECT_LT((centroid - Vec3d(1, 2, 0)).length(), 1e-4);
}

TEST(PatchSampling, IsUniformOverATrapezoid) {
  test::PatchScene builder;
  builder.quad({{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  const Vec3d centroid = sampled_centroid(builder.get().primitives[0], builder.get().patches[0]);
  EXPECT_LT((centroid - Vec3d(7.0 / 9, 4.0 / 9, 0)).length(), 1e-4);  // centroid of a trapezoid
}

TEST(PatchSampling, IsUniformOverASphere) {
  test::PatchScene builder;
  builder.sphere({1, 2, 3}, 2, 2, 1, {});  // upper hemisphere: centroid at R / 2
  const Vec3d centroid = sampled_centroid(builder.get().primitives[0], builder.get().patches[0]);
  EXPECT_LT((centroid - Vec3d(1, 3, 3)).length(), 1e-3);
}

TEST(PatchSampling, SphereAzimuthStartsAtXAndGrowsTowardsMinusZ) {
  Primitive sphere;
  sphere.shape = Primitive::Shape::sphere;
  sphere.sphere_radius = 1;
  EXPECT_LT((point_at(sphere, 0, 0.5).position - Vec3d(1, 0, 0)).length(), 1e-12);
  EXPECT_LT((point_at(sphere, 0.25, 0.5).position - Vec3d(0, 0, -1)).length(), 1e-12);
  EXPECT_LT((point_at(sphere, 0.3, 0).position - Vec3d(0, 1, 0)).length(), 1e-12);
  sphere.sphere_radius = -1;
  EXPECT_LT((point_at(sphere, 0, 0.5).normal - Vec3f(-1, 0, 0)).length(), 1e-6f);
}

TEST(PatchSampling, CosineDirectionsHaveAMeanCosineOfTwoThirds) {
  double sum = 0;
  constexpr int kSide = 512;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const Vec3f d = cosine_direction((float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide);
      EXPECT_NEAR(d.length(), 1.0f, 1e-5f);
      sum += d.z;
    }
  EXPECT_NEAR(sum / (kSide * kSide), 2.0 / 3.0, 1e-4);
}

TEST(PatchSampling, FramesAreOrthonormalAndRightHanded) {
  for (const Vec3f& n : {Vec3f(0, 0, 1), Vec3f(0, 0, -1), Vec3f(1, 0, 0), Vec3f(0.6f, 0, -0.8f), Vec3f(0, -1, 0)}) {
    Vec3f t, b;
    orthonormal_frame(n, t, b);
    EXPECT_NEAR(t.length(), 1, 1e-6);
    EXPECT_LT((t % b - n).length(), 1e-6f);
  }
}

TEST(PatchSampling, IsUniformOverACluster) {
  test::PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  builder.cluster({{{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}}}, {{{3, 0, 0}, {3, 0, 2}, {3, 1, 2}, {3, 1, 0}}}}, {});
  const PatchSet& scene = builder.get();
  const PatchLookup lookup(scene);
  EXPECT_EQ(lookup.patch(0, 0.5f, 0.5f), 0);
  EXPECT_EQ(lookup.patch(1, 0.5f, 0.5f), 1);
  EXPECT_EQ(lookup.patch(2, 0.5f, 0.5f), 1);
  const PatchSampler sample(scene.primitives, scene.patches[1]);
  Vec3d sum(0.0);
  constexpr int kSide = 100;
  for (int k = 0; k < kSide * kSide; ++k) {
    const float x = (float(k % kSide) + 0.5f) / kSide, y = (float(k / kSide) + 0.5f) / kSide;
    const SurfacePoint point = sample(x, y);
    const auto [primitive, uv] = sample.place(x, y);
    sum += point.position / (kSide * kSide);
    EXPECT_EQ(primitive, x < 0.6f ? 1 : 2);
    EXPECT_LT((position_at(scene.primitives[primitive].corners, uv.x, uv.y) - point.position).length(), 1e-9);
    EXPECT_LT((point.normal - point_at(scene.primitives[primitive], 0.5, 0.5).normal).length(), 1e-6f);
  }
  EXPECT_LT((sum - Vec3d(0.6 * 1.5 + 0.4 * 3, 0.5, 0.4)).length(), 1e-3);
}

}  // namespace
}  // namespace patchlight
