#include "pipeline/optics/lights/direct_light.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/optics/sampling/random.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

const std::array<Vec3d, 4> kSquareAbove{{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}};  // lit downwards

DirectLight light_of(const PatchSet& scene) {
  const RayScene rays(scene);
  return DirectLight(scene, rays, explicit_emitters(scene).at(0));
}

/// Compares the mean weight of many samples with the closed form.
void expect_samples_to_agree(const DirectLight& light, const Vec3d& point, const Vec3f& normal, double tolerance) {
  constexpr int kSide = 256;
  double sum = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const auto s = light.sample(point, normal, (float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide);
      ASSERT_TRUE(std::isfinite(s.weight) && s.weight >= 0);
      if (s.weight == 0) continue;
      EXPECT_NEAR(s.direction.length(), 1, 1e-5);
      EXPECT_GE(s.distance, 0);
      sum += s.weight;
    }
  const double exact = light.form_factor(point, normal);
  EXPECT_NEAR(sum / (kSide * kSide), exact, tolerance * exact) << point.x << " " << point.y << " " << point.z;
}

TEST(DirectLight, OfAParallelSquareBelowItsCorner) {
  PatchScene builder;
  builder.quad(kSquareAbove, 2, 2, {0.0f, 1.0f});
  const double x = 1, y = 1;  // sides over distance: Howell B-3
  const double exact = (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                        y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y))) /
                       (2 * kPi);
  const DirectLight light = light_of(builder.get());
  EXPECT_NEAR(light.form_factor({0, 0, 0}, {0, 1, 0}), exact, 1e-12);
  EXPECT_EQ(light.form_factor({0, 0, 0}, {0, -1, 0}), 0);
  EXPECT_EQ(light.form_factor({0, 2, 0}, {0, -1, 0}), 0) << "the unlit side";
}

TEST(DirectLight, DoesNotReachTheOtherSideOfItsOwnPlane) {
  for (int k = 0; k < 200; ++k) {
    const auto random = [&](int i) { return 2 * double(uniform01(hash64(std::uint64_t(8 * k + i)))) - 1; };
    const Vec3d corner(100 * random(0), random(1), random(2)), up = Vec3d(random(3), random(4), random(5)).normalized();
    const Vec3d along = (up % Vec3d(random(6), 1, random(7))).normalized(), across = up % along;
    PatchScene builder;
    builder.quad({{corner, corner + along, corner + along + across, corner + across}}, 1, 1, {0.0f, 1.0f});
    const DirectLight light = light_of(builder.get());
    for (int point = 0; point < 16; ++point) {
      const Vec2f at = kronecker2(std::uint64_t(point), std::uint64_t(k));
      const Vec3d coplanar = Vec3d(Vec3f(corner + along * (3 * double(at.x) - 1) + across * (3 * double(at.y) - 1)));
      EXPECT_EQ(light.form_factor(coplanar, -Vec3f(up)), 0) << k;
      EXPECT_EQ(light.sample(coplanar, -Vec3f(up), at.x, at.y).weight, 0) << k;
      EXPECT_EQ(light.form_factor(coplanar - up * 1e-5, -Vec3f(up)), 0) << k;
    }
  }
}

TEST(DirectLight, IsClippedAtTheHorizon) {
  PatchScene whole, upper;
  whole.quad({{{-1, 1, 1}, {1, 1, 1}, {1, -1, 1}, {-1, -1, 1}}}, 1, 1, {0.0f, 1.0f});
  upper.quad({{{-1, 1, 1}, {1, 1, 1}, {1, 0, 1}, {-1, 0, 1}}}, 1, 1, {0.0f, 1.0f});
  const Vec3d point(0.3, 0, 0);
  const double cut = light_of(whole.get()).form_factor(point, {0, 1, 0});
  EXPECT_GT(cut, 0.05);
  EXPECT_NEAR(cut, light_of(upper.get()).form_factor(point, {0, 1, 0}), 1e-12);
}

TEST(DirectLight, IsTheSumOfItsPartsForAnyHorizon) {
  constexpr int kParts = 3;
  PatchScene builder;
  builder.quad(kSquareAbove, 1, 1, {0.0f, 1.0f});
  for (int k = 0; k < kParts * kParts; ++k) {
    const double x = k % kParts, z = k / kParts;
    builder.quad({{Vec3d(x, kParts, z) / kParts, Vec3d(x + 1, kParts, z) / kParts, Vec3d(x + 1, kParts, z + 1) / kParts,
                   Vec3d(x, kParts, z + 1) / kParts}},
                 1, 1, {0.0f, 1.0f});
  }
  const RayScene rays(builder.get());
  std::vector<DirectLight> lights;
  for (const Emitter& emitter : explicit_emitters(builder.get())) lights.emplace_back(builder.get(), rays, emitter);
  ASSERT_EQ(lights.size(), 1u + kParts * kParts);
  int cut = 0;
  for (std::uint64_t k = 0; k < 2000; ++k) {
    const auto unit = [&](std::uint64_t axis) { return 2.0 * uniform01(hash64(8 * k + axis)) - 1.0; };
    const Vec3d point(1.5 * unit(0), 1 - 0.01 * (1 + 60 * (1 + unit(1))), 1.5 * unit(2));
    const Vec3f normal = Vec3f(Vec3d(unit(3), unit(4), unit(5))).normalized();
    double sum = 0;
    for (std::size_t part = 1; part < lights.size(); ++part) sum += lights[part].form_factor(point, normal);
    EXPECT_NEAR(lights[0].form_factor(point, normal), sum, 1e-11) << k;
    cut += lights[0].form_factor(point, normal) > 0 && lights[1].form_factor(point, normal) == 0;
  }
  EXPECT_GT(cut, 100);
}

TEST(DirectLight, OfASphereAtAnyHeightOfTheHorizon) {
  PatchScene builder;
  builder.sphere({0, 3, 0}, 1, 4, 8, {0.0f, 1.0f});
  const DirectLight light = light_of(builder.get());
  EXPECT_NEAR(light.form_factor({0, 0, 0}, {0, 1, 0}), 1.0 / 9, 1e-12);
  EXPECT_EQ(light.form_factor({0, 3.5, 0}, {0, 1, 0}), 0) << "inside";
  for (const double tilt : {0.2, 1.0, 1.3, 1.5, 1.8}) {
    const Vec3f normal(float(std::sin(tilt)), float(std::cos(tilt)), 0);
    expect_samples_to_agree(light, {0, 0, 0}, normal, 1e-3);
  }
  EXPECT_EQ(light.form_factor({0, 0, 0}, {0, -1, 0}), 0);
}

TEST(DirectLight, SamplesAverageToTheFormFactorNearAndFar) {
  const std::vector<std::array<Vec3d, 4>> shapes{
      kSquareAbove,
      {{{0, 1, 0}, {2, 1, 0}, {0.7, 1, 1}, {0.7, 1, 1}}},          // triangle
      {{{0, 1, 0}, {1, 1, 0}, {1.7, 1, 1.3}, {-0.2, 1, 0.8}}},     // general
      {{{0, 1, 0}, {1e-3, 1, 0}, {1e-3, 1, 1e-3}, {0, 1, 1e-3}}},  // tiny
      {{{-50, 1, -50}, {50, 1, -50}, {50, 1, 50}, {-50, 1, 50}}},  // huge
  };
  for (const auto& shape : shapes) {
    PatchScene builder;
    builder.quad(shape, 1, 1, {0.0f, 1.0f});
    const DirectLight light = light_of(builder.get());
    for (const Vec3d& point : {Vec3d(0.3, 0, 0.2), Vec3d(0.5, 0.98, 0.4), Vec3d(-1, 0.5, 2), Vec3d(9, -8, 3)})
      for (const Vec3f& normal : {Vec3f(0, 1, 0), Vec3f(0.6f, 0.8f, 0), Vec3f(0, 0, -1)})
        if (light.form_factor(point, normal) > 1e-9) expect_samples_to_agree(light, point, normal, 0.01);
  }
}

TEST(DirectLight, IsTranslationInvariant) {
  const Vec3d far(1e4, -1e4, 1e4);
  std::array<Vec3d, 4> moved = kSquareAbove;
  for (Vec3d& corner : moved) corner += far;
  PatchScene here, there;
  here.quad(kSquareAbove, 1, 1, {0.0f, 1.0f});
  there.quad(moved, 1, 1, {0.0f, 1.0f});
  const Vec3d point(0.3, 0.2, 0.4);
  const double a = light_of(here.get()).form_factor(point, {0, 1, 0});
  EXPECT_NEAR(light_of(there.get()).form_factor(point + far, {0, 1, 0}) / a, 1.0, 1e-10);
}

Light light_at(const Vec3d& position, Light::Kind kind = Light::Kind::point) {
  Light light;
  light.kind = kind;
  light.position = position;
  light.direction = {0, -1, 0};
  return light;
}

TEST(DirectLight, OfAPointFollowsTheInverseSquareLaw) {
  const DirectLight light(light_at({3, 4, 0}));
  EXPECT_NEAR(light.form_factor({0, 0, 0}, {0, 1, 0}), 0.8 / 25, 1e-12);
  EXPECT_NEAR(light.form_factor({0, 0, 0}, {1, 0, 0}), 0.6 / 25, 1e-12);
  EXPECT_EQ(light.form_factor({0, 0, 0}, {0, -1, 0}), 0);
  EXPECT_EQ(light.form_factor({3, 4, 0}, {0, 1, 0}), 0) << "at the light itself";
  const DirectLight::Sample sample = light.sample({0, 0, 0}, {0, 1, 0}, 0.3f, 0.8f);
  EXPECT_NEAR(sample.weight, 0.8 / 25, 1e-7);
  EXPECT_LT(sample.distance, 5);
  EXPECT_GT(sample.distance, 4.999);
  EXPECT_TRUE(light.cannot_illuminate(std::array{Vec3d(0, 5, 0)}, {0, 1, 0}));
  EXPECT_FALSE(light.cannot_illuminate(std::array{Vec3d(0, 3, 0)}, {0, 1, 0}));
}

TEST(DirectLight, OfASpotFallsOffBetweenItsCones) {
  Light spot = light_at({0, 2, 0}, Light::Kind::spot);
  spot.inner = 0.3;
  spot.outer = 0.6;
  const DirectLight light(spot);
  for (const double angle : {0.0, 0.29, 0.4, 0.5, 0.59, 0.61, 2.0}) {
    const Vec3d place = Vec3d(0, 2, 0) + Vec3d(std::sin(angle), -std::cos(angle), 0) * 2;
    const Vec3f normal(Vec3d(0, 2, 0) - place);
    // KHR_lights_punctual, "Inner and Outer Cone Angles".
    const double scale = 1 / std::max(0.001, std::cos(0.3) - std::cos(0.6)), offset = -std::cos(0.6) * scale;
    const double part = std::clamp(std::cos(angle) * scale + offset, 0.0, 1.0);
    EXPECT_NEAR(light.form_factor(place, normal.normalized()), part * part / 4, 1e-7) << angle;
  }
  spot.inner = spot.outer;
  const DirectLight sharp(spot);
  EXPECT_NEAR(sharp.form_factor({2 * std::tan(0.59), 0, 0}, {0, 1, 0}), std::pow(std::cos(0.59), 3) / 4, 1e-12);
  EXPECT_EQ(sharp.form_factor({2 * std::tan(0.61), 0, 0}, {0, 1, 0}), 0);
}

TEST(DirectLight, OfASunDependsOnTheNormalAlone) {
  Light sun = light_at({0, 0, 0}, Light::Kind::sun);
  sun.direction = Vec3d(0.6, -0.8, 0);
  const DirectLight light(sun);
  for (const Vec3d& place : {Vec3d(0.0), Vec3d(1e6, 5, -3)}) {
    EXPECT_NEAR(light.form_factor(place, {0, 1, 0}), 0.8, 1e-12);
    EXPECT_TRUE(std::isinf(light.sample(place, {0, 1, 0}, 0.5f, 0.5f).distance));
  }
  EXPECT_EQ(light.form_factor({0, 0, 0}, {0.6f, -0.8f, 0}), 0);
}

TEST(DirectLight, OfASunWithARadiusIsTheMeanOverItsDisk) {
  Light sun = light_at({0, 0, 0}, Light::Kind::sun);
  sun.direction = Vec3d(0.6, -0.8, 0);
  sun.outer = 0.2;
  const DirectLight light(sun);
  EXPECT_NEAR(light.form_factor({0, 0, 0}, {0, 1, 0}), 0.8, 1e-12);
  for (const double tilt : {0.0, 0.9, 1.5, 1.6, 1.7})  // the horizon cuts the last
    expect_samples_to_agree(light, {5, 6, 7}, Vec3f(float(-std::cos(tilt)), float(std::sin(tilt)), 0), 2e-3);
  EXPECT_EQ(light.form_factor({0, 0, 0}, {0.6f, -0.8f, 0}), 0);
}

TEST(ExplicitEmitters, ListEveryLightAfterTheSurfaces) {
  PatchScene builder;
  builder.quad(kSquareAbove, 2, 2, {0.5f, 1.0f});
  builder.get().lights.assign(100, light_at({0, 5, 0}));
  const std::vector<Emitter> emitters = explicit_emitters(builder.get());
  ASSERT_EQ(emitters.size(), 101u);
  EXPECT_EQ(emitters[0].light, -1);
  EXPECT_EQ(emitters[100].light, 99);
  EXPECT_EQ(emitters[100].patches, 0);
}

TEST(ExplicitEmitters, ArePrimitivesOfUniformEmissionOrElsePatches) {
  PatchScene builder;
  builder.quad(kSquareAbove, 2, 2, {0.5f, 1.0f});
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 2, 1, {0.5f, 1.0f});
  builder.sphere({5, 5, 5}, 1, 3, 4, {0.5f, 1.0f});
  builder.sphere({5, 5, 5}, -9, 3, 4, {0.5f, 1.0f});
  PatchSet& scene = builder.get();
  scene.patches[5].emission = Color(2.0f);
  const std::vector<Emitter> emitters = explicit_emitters(scene);
  ASSERT_EQ(emitters.size(), 4u);
  EXPECT_EQ(emitters[0].patches, 4);
  EXPECT_NEAR(emitters[0].area, 1.0, 1e-6);
  EXPECT_EQ(emitters[1].first_patch, 4);
  EXPECT_EQ(emitters[1].patches, 1);
  EXPECT_EQ(emitters[2].first_patch, 5);
  EXPECT_EQ(emitters[3].first_patch, 6);
  EXPECT_EQ(emitters[3].patches, 12);
}

TEST(ExplicitEmitters, AreTheLargestPrimitives) {
  PatchScene builder;
  for (int i = 0; i < 100; ++i) {
    const double size = i == 70 ? 0.5 : 0.1;
    const Vec3d at(i, 0, 0);
    builder.quad({at, at + Vec3d(size, 0, 0), at + Vec3d(size, 0, size), at + Vec3d(0, 0, size)}, 1, 1, {0.5f, 1.0f});
  }
  const std::vector<Emitter> emitters = explicit_emitters(builder.get());
  EXPECT_EQ(emitters.size(), 64u);
  EXPECT_TRUE(std::any_of(emitters.begin(), emitters.end(), [](const Emitter& e) { return e.primitive == 70; }));
}

TEST(DirectLight, KnowsTheDensityOfItsSamples) {
  PatchScene builder;
  builder.quad({{{0, 0, 2}, {0, 1, 2}, {2, 1, 2}, {1, 0, 2}}}, 1, 1, {0.0f, 1.0f});
  builder.sphere({-3, 0, 1}, 0.5, 2, 4, {0.0f, 1.0f});
  const RayScene rays(builder.get());
  for (const Emitter& emitter : explicit_emitters(builder.get())) {
    const DirectLight light(builder.get(), rays, emitter);
    for (const Vec3d& point : {Vec3d(0.3, 0.2, 0.5), Vec3d(20, 0, -15)}) {
      const DirectLight::View view = light.view(point, Vec3f(0, 0, 1));
      for (std::uint64_t k = 0; k < 100; ++k) {
        const Vec2f at = kronecker2(k, 7);
        const DirectLight::Sample sample = view.sample(at.x, at.y);
        if (sample.weight <= 0) continue;
        const double density = sample.direction.z / (kPi * sample.weight);
        EXPECT_NEAR(view.density(sample.direction), density, 1e-4 * density) << emitter.primitive << point;
      }
      EXPECT_GE(light.apparent_size(point), light.form_factor(point, Vec3f(0, 0, 1)) / 4);
    }
  }
  const DirectLight light(builder.get(), rays, explicit_emitters(builder.get())[0]);
  EXPECT_EQ(light.apparent_size({0, 0, 3}), 0) << "from behind";
}

}  // namespace
}  // namespace patchlight
