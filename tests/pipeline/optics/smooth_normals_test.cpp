#include "pipeline/optics/surface/smooth_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// The sides of an octagonal prism from y = 0 to 1, lit outside.
PatchScene prism(bool smooth) {
  PatchScene builder;
  const auto corner = [](int k, double y) { return Vec3d(std::cos(k * kPi / 4), y, std::sin(k * kPi / 4)); };
  for (int k = 0; k < 8; ++k) {
    builder.quad({{corner(k + 1, 0), corner(k, 0), corner(k, 1), corner(k + 1, 1)}}, 1, 1, {});
    const Vec3f left(corner(k + 1, 0)), right(corner(k, 0));
    if (smooth) builder.get().normals.push_back({left, right, right, left});
  }
  return builder;
}

TEST(SmoothNormals, AreRadialOnACylinder) {
  PatchScene builder = prism(true);
  const PatchSet& scene = builder.get();
  const SmoothNormals normals(scene);
  for (std::int32_t i = 0; i < 8; ++i)
    for (const float u : {0.0f, 0.2f, 0.5f, 1.0f}) {
      const SurfacePoint point = point_at(scene.primitives[i], u, 0.7);
      const Vec3f radial = Vec3f(float(point.position.x), 0.0f, float(point.position.z)).normalized();
      EXPECT_GT(normals(i, u, 0.7f, point.normal) ^ radial, 0.9999f) << i << " " << u;
    }
}

TEST(SmoothNormals, StayFlatAtCreasesAndOnPlanes) {
  PatchScene builder = prism(false);
  builder.sphere({5, 0, 0}, 1, 3, 4, {});
  const PatchSet& scene = builder.get();
  const SmoothNormals normals(scene);
  for (std::int32_t i = 0; i < 9; ++i) {
    const Vec3f flat = point_at(scene.primitives[i], 0.1, 0.1).normal;
    EXPECT_EQ(normals(i, 0.1f, 0.1f, flat), flat);
  }
}

TEST(SmoothNormals, LiftPointsOntoTheCylinderTheyDescribe) {
  PatchScene builder = prism(true);
  const PatchSet& scene = builder.get();
  const SmoothNormals normals(scene);
  for (const float u : {0.0f, 0.2f, 0.5f, 1.0f}) {
    const Vec3d point = point_at(scene.primitives[0], u, 0.7).position;
    const Vec3d lifted = normals.on_smooth_surface(0, u, 0.7f, point);
    EXPECT_NEAR(std::hypot(lifted.x, lifted.z), 1.0, 0.076) << "the facet's sagitta";
    EXPECT_GE(std::hypot(lifted.x, lifted.z), std::hypot(point.x, point.z) - 1e-12);
  }
  PatchScene inward = prism(true);  // a tube lit inside: its smooth surface lies behind the facets
  for (std::size_t i = 0; i < 8; ++i) {
    std::swap(inward.get().primitives[i].corners[0], inward.get().primitives[i].corners[1]);
    std::swap(inward.get().primitives[i].corners[2], inward.get().primitives[i].corners[3]);
    CornerNormals& n = inward.get().normals[i];
    n = {-n[1], -n[0], -n[3], -n[2]};
  }
  const Vec3d point = point_at(inward.get().primitives[0], 0.5, 0.5).position;
  EXPECT_EQ(SmoothNormals(inward.get()).on_smooth_surface(0, 0.5f, 0.5f, point), point);
}

TEST(SmoothNormals, AreValidForViewersOfWhichTheSurfaceHasAMirrorImage) {
  const Vec3f flat(0, 0, 1);
  for (const float tilt : {0.1f, 0.5f, 1.0f, 1.4f})
    for (const float angle : {-1.5f, -1.2f, -0.5f, 0.0f, 0.7f, 1.3f, 1.55f}) {
      const Vec3f normal(std::sin(tilt), 0, std::cos(tilt)),
          viewer(std::sin(angle) * 0.8f, std::sin(angle) * 0.6f, std::cos(angle));
      const Vec3f valid = valid_for_viewer(normal, flat, viewer);
      const float height = (valid * (2 * (valid ^ viewer)) - viewer).z;
      const float least = std::min(0.01f, 0.9f * viewer.z);
      EXPECT_NEAR(valid.length(), 1.0f, 1e-5f);
      EXPECT_GE(height, least - 1e-4f) << tilt << " " << angle;
      EXPECT_NEAR(valid.y, 0.0f, 1e-6f) << "it is turned towards the surface's own normal";
      if ((normal * (2 * (normal ^ viewer)) - viewer).z > least)
        EXPECT_EQ(valid, normal) << "it was valid";
      else
        EXPECT_NEAR(height, least, 1e-4f) << "and no farther than needed";
    }
}

/// A level square lit above, 2 m wide, with a normal texture of one texel that leans by x, y; texture coordinates run
/// with x and z, s from 0 to 1 and t downwards in the picture, which is seen from above with -z up.
PatchScene with_texel(float x, float y, const Texcoords& texcoords) {
  PatchScene builder;
  builder.quad({{{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}}, 1, 1, {});
  PatchSet& scene = builder.get();
  const auto level = [](float value) { return std::int32_t(std::lround(127.5f * (value + 1.0f))); };
  scene.textures.push_back({1, 1, {}, true, {level(x) << 16 | level(y) << 8 | level(std::sqrt(1 - x * x - y * y))}});
  scene.texcoords = {texcoords};
  scene.primitives[0].normal_texture = 0;
  return builder;
}

Vec3f mapped(const PatchScene& builder, std::int32_t i = 0, float u = 0.3f, float v = 0.6f) {
  PatchScene copy = builder;
  const PatchSet& scene = copy.get();
  const Vec3f flat = point_at(scene.primitives[i], double(u), double(v)).normal;
  return SmoothNormals(scene).mapped(i, u, v, flat);
}

const Texcoords kAsSeen{Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0), Vec2f(0, 0)};

void expect_near(const Vec3f& a, const Vec3f& b) {
  EXPECT_LT((a - b).length(), 0.01f) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(NormalTextures, LeanRightAndUpInThePicture) {
  expect_near(mapped(with_texel(0, 0, kAsSeen)), {0, 1, 0});
  expect_near(mapped(with_texel(0.6f, 0, kAsSeen)), {0.6f, 0.8f, 0});
  expect_near(mapped(with_texel(0, 0.6f, kAsSeen)), {0, 0.8f, -0.6f});
  const Texcoords turned{Vec2f(1, 1), Vec2f(1, 0), Vec2f(0, 0), Vec2f(0, 1)};  // the picture's right is +z
  expect_near(mapped(with_texel(0.6f, 0, turned)), {0, 0.8f, 0.6f});
  expect_near(mapped(with_texel(0, 0.6f, turned)), {0.6f, 0.8f, 0});
  const Texcoords mirrored{Vec2f(1, 1), Vec2f(0, 1), Vec2f(0, 0), Vec2f(1, 0)};
  expect_near(mapped(with_texel(0.6f, 0, mirrored)), {-0.6f, 0.8f, 0});
  expect_near(mapped(with_texel(0, 0.6f, mirrored)), {0, 0.8f, -0.6f});
}

TEST(NormalTextures, AreScaledAndReversedOnBacks) {
  PatchScene builder = with_texel(0.6f, 0, kAsSeen);
  builder.get().materials[0].normal_scale = 0.5f;
  expect_near(mapped(builder), Vec3f(0.3f, 0.8f, 0).normalized());
  builder = with_texel(0.6f, 0, kAsSeen);
  builder.quad({{{1, 0, 1}, {-1, 0, 1}, {-1, 0, -1}, {1, 0, -1}}}, 1, 1, {});
  PatchSet& scene = builder.get();
  scene.texcoords.push_back({kAsSeen[1], kAsSeen[0], kAsSeen[3], kAsSeen[2]});
  scene.primitives[1].normal_texture = 0;
  scene.primitives[0].back = 1;
  scene.primitives[1].back = 0;
  expect_near(mapped(builder, 1), {-0.6f, -0.8f, 0});
}

TEST(NormalTextures, WithoutUsableCoordinatesChangeNothing) {
  Texcoords point;
  point.fill(Vec2f(0.5f));
  expect_near(mapped(with_texel(0.6f, 0, point)), {0, 1, 0});
}

}  // namespace
}  // namespace patchlight
