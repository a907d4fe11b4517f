#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::light_at;
using test::PatchScene;
using test::Solved;

/// The upper half of a cylinder of radius 1 along z, of `count` facets, smooth.
PatchScene half_cylinder(int count) {
  PatchScene builder;
  const auto corner = [&](int k, double z) { return Vec3d(std::cos(k * kPi / count), std::sin(k * kPi / count), z); };
  for (int k = 0; k < count; ++k) {
    builder.quad({{corner(k, 4), corner(k, -4), corner(k + 1, -4), corner(k + 1, 4)}}, 1, 1, {0.5f});
    Vec3f right(corner(k, 0)), left(corner(k + 1, 0));
    builder.get().normals.push_back({right, right, left, left});
    builder.get().primitives.back().smooth_vertices = {2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2};
  }
  return builder;
}

/// From above in parallel projection; pixel columns run along x from -0.9 to 0.9.
Solved from_above(PatchScene& builder) {
  Solved solved(builder, 0.0f, 0.0f);
  solved.camera.projection = Camera::Projection::orthographic;
  solved.camera.vertical = 0.9;
  solved.camera.to_world.rotate(Vec3d(-kPi / 2, 0, 0));
  solved.camera.to_world.x[3][1] = 10;
  solved.job.trace.quality = "direct";
  solved.job.trace.resolution = {45, 45};
  solved.job.trace.samples = 16;
  Light sun = light_at({0, 5, 0}, Light::Kind::sun);
  sun.direction = Vec3d(-1, -0.25, 0).normalized();
  solved.scene.lights = {sun};
  return solved;
}

TEST(SmoothNormalsInFrames, HaveNoBlackFacetsAtTheTerminator) {
  for (const int facets : {6, 12}) {
    PatchScene builder = half_cylinder(facets);
    Solved solved = from_above(builder);
    const Image image = solved.render();
    const Vec3d to_sun = -solved.scene.lights[0].direction;
    int lit = 0;
    for (std::size_t p = 22 * 45; p < 23 * 45; ++p) {
      const Vec3d point((double(p % 45) + 0.5) * 0.04 - 0.9, 0, 0);  // the smooth normal there, from its facet
      int k = 0;
      while (std::cos((k + 1) * kPi / facets) > point.x) ++k;
      const Vec3d right(std::cos(k * kPi / facets), std::sin(k * kPi / facets), 0);
      const Vec3d left(std::cos((k + 1) * kPi / facets), std::sin((k + 1) * kPi / facets), 0);
      const double part = (right.x - point.x) / (right.x - left.x);
      const double cosine = (right * (1 - part) + left * part).normalized() ^ to_sun;
      const double full = 0.5 / kPi * double(solved.scene.lights[0].strength.x);
      lit += cosine > 0.05;
      EXPECT_NEAR(image.pixels[p].x / full, std::max(0.0, cosine), 0.04) << facets << " facets, x = " << point.x;
    }
    EXPECT_GT(lit, 20);
  }
}

TEST(SmoothNormalsInFrames, DoNotMoveShadowRaysThroughOtherSurfaces) {
  PatchScene builder = half_cylinder(6);
  // A slab close above the middle of a facet: nearer than the smooth surface, which is 0.034 above it.
  const Vec3d a(std::cos(kPi / 2), std::sin(kPi / 2), 0), b(std::cos(kPi / 3), std::sin(kPi / 3), 0);
  const Vec3d up = (a + b).normalized() * 0.01, z(0, 0, 4);
  builder.quad({{b + up - z, b + up + z, a + up + z, a + up - z}}, 1, 1, {0.0f});  // faces down
  Solved solved = from_above(builder);
  solved.job.trace.cull_backfaces = true;
  const Image image = solved.render();
  for (int x = 25; x < 33; ++x) {
    const std::size_t p = std::size_t(22 * 45 + x);
    EXPECT_LT(image.pixels[p].x, 1e-3) << "x = " << double(x) * 0.04 - 0.88;
  }
}

/// A level floor whose normal texture leans towards +x, under a sun.
TEST(NormalTexturesInFrames, FollowTheCosineOfTheTurnedNormal) {
  for (const double lean : {0.0, 0.6}) {
    for (const double slope : {0.8, -0.8}) {  // of the direction to the sun, along x
      PatchScene builder;
      builder.quad({{{-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}}}, 1, 1, {0.5f});
      PatchSet& scene = builder.get();
      const auto level = [](double value) { return std::int32_t(std::lround(127.5 * (value + 1))); };
      scene.textures.push_back(
          {1, 1, {}, true, {level(lean) << 16 | level(0) << 8 | level(std::sqrt(1 - lean * lean))}});
      scene.texcoords = {{Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0), Vec2f(0, 0)}};
      scene.primitives[0].normal_texture = 0;
      scene.primitives[0].light_group = -1;
      Light sun;
      sun.kind = Light::Kind::sun;
      sun.direction = Vec3d(-slope, -1, 0).normalized();
      sun.strength = Color(1.0f);
      sun.light_group = 0;
      scene.lights.push_back(sun);
      Solved solved(builder, 0.0f, 0.0f);
      solved.job.trace.quality = "direct";
      solved.camera.to_world.rotate(Vec3d(-kPi / 2, 0, 0));
      solved.camera.to_world[3][1] = 3;
      solved.camera.vertical = 0.1;
      const Vec3d normal(lean, std::sqrt(1 - lean * lean), 0);
      const double cosine = std::max(0.0, -(sun.direction ^ normal));
      const Image image = solved.render();
      const double flat = -sun.direction.y;
      Solved plain = solved;
      plain.scene.primitives[0].normal_texture = -1;
      EXPECT_NEAR(image.pixels[27].x / plain.render().pixels[27].x, cosine / flat, 0.02) << lean << ' ' << slope;
    }
  }
}

}  // namespace
}  // namespace patchlight
