#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/sampling/random.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::light_at;

Light ball_at(const Vec3d& position, double radius, Light::Kind kind = Light::Kind::point) {
  Light light = light_at(position, kind);
  light.radius = radius;
  return light;
}

double mean_of_samples(const DirectLight& light, const Vec3d& point, const Vec3f& normal) {
  constexpr int kSide = 256;
  const DirectLight::View view = light.view(point, normal);
  double sum = 0;
  for (int k = 0; k < kSide * kSide; ++k)
    sum += double(view.sample((float(k % kSide) + 0.5f) / kSide, (float(k / kSide) + 0.5f) / kSide).weight);
  return sum / (kSide * kSide);
}

TEST(LightWithARadius, HasTheIntensityOfAPointAtAnyDistance) {
  const DirectLight point(light_at({0, 2, 0})), ball(ball_at({0, 2, 0}, 0.5));
  for (const double x : {0.0, 0.4, 3.0, 100.0})
    EXPECT_NEAR(ball.form_factor({x, 0, 0}, {0, 1, 0}), point.form_factor({x, 0, 0}, {0, 1, 0}), 1e-9) << x;
  EXPECT_FALSE(ball.is_point());
}

TEST(LightWithARadius, IsCutByTheHorizonAndLightsFromInside) {
  const DirectLight ball(ball_at({0, 0, 0}, 1));
  const double low = ball.form_factor({-2, 0, 0}, {0, 1, 0});
  EXPECT_GT(low, 0.01) << "a point at the horizon would light nothing";
  EXPECT_NEAR(mean_of_samples(ball, {-2, 0, 0}, {0, 1, 0}), low, 0.002 * low);
  EXPECT_EQ(ball.form_factor({0, 1.1, 0}, {0, 1, 0}), 0);
  EXPECT_NEAR(ball.form_factor({0, 0.5, 0}, {0, 1, 0}), 1, 1e-12);
  EXPECT_NEAR(mean_of_samples(ball, {0, 0.5, 0}, {0, 1, 0}), 1, 1e-5);
  EXPECT_NEAR(ball.form_factor({0, 1.0001, 0}, {0, -1, 0}), 1, 1e-3) << "no step at its surface";
}

TEST(LightWithARadius, IsSampledOnItsNearSide) {
  const DirectLight ball(ball_at({0, 3, 0}, 1));
  for (int k = 0; k < 64; ++k) {
    const Vec2f at = kronecker2(std::uint64_t(k), 5);
    const DirectLight::Sample sample = ball.sample({0, 0, 0}, {0, 1, 0}, at.x, at.y);
    const Vec3d end = Vec3d(sample.direction) * double(sample.distance);
    EXPECT_NEAR((end - Vec3d(0, 3, 0)).length(), 1, 1e-3);
    EXPECT_LT(end.y, 3);
    const DirectLight::Sample inside = ball.sample({0, 2.5, 0}, {0, -1, 0}, at.x, at.y);
    EXPECT_NEAR((Vec3d(0, 2.5, 0) + Vec3d(inside.direction) * double(inside.distance) - Vec3d(0, 3, 0)).length(), 1,
                1e-5);
  }
}

TEST(LightWithARadius, OfASpotIsTheMeanOfItsSamplesAcrossTheEdgeOfTheCone) {
  for (const double inner : {0.3, 0.6}) {
    Light spot = ball_at({0, 2, 0}, 0.2, Light::Kind::spot);
    spot.inner = inner;
    spot.outer = 0.6;
    const DirectLight light(spot);
    const double whole = light.form_factor({0, 0, 0}, {0, 1, 0});
    EXPECT_NEAR(whole, 0.25, 0.25e-3);
    for (const double x : {0.5, 1.0, 1.1, 1.15, 1.2, 1.3, 1.4, 1.5, 1.55, 1.6, 1.65, 1.7})
      EXPECT_NEAR(light.form_factor({x, 0, 0}, {0, 1, 0}), mean_of_samples(light, {x, 0, 0}, {0, 1, 0}),
                  (inner < 0.6 ? 0.002 : 0.005) * whole)
          << inner << " " << x;
  }
}

TEST(LightWithARadius, AsMirroredLightsTheMirroredPoint) {
  Light spot = ball_at({0.5, 2, 0.25}, 0.2, Light::Kind::spot);
  spot.direction = Vec3d(0.3, -1, 0.2).normalized();
  spot.outer = 0.5;
  PatchSet scene = [] {
    test::PatchScene builder;
    builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
    builder.quad({{{2, 0, -9}, {2, 0, 9}, {2, 9, 9}, {2, 9, -9}}}, 1, 1, {0.0f, 0.0f, 0, 1});
    return builder.get();
  }();
  const RayScene rays(scene);
  const DirectLight light(spot), image = light.image(PlaneMirror(scene, rays, 0));
  for (const double x : {0.3, 1.0, 1.6})
    EXPECT_NEAR(image.form_factor({4 - x, 0, 0.5}, {0, 1, 0}), light.form_factor({x, 0, 0.5}, {0, 1, 0}),
                0.01 * light.form_factor({1, 0, 0.5}, {0, 1, 0}));
}

}  // namespace
}  // namespace patchlight
