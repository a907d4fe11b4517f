#include "pipeline/model/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/model/camera.h"

namespace patchlight {
namespace {

using Kind = Motion::Kind;
using Interpolation = Motion::Interpolation;

Motion translation(Interpolation interpolation, std::vector<double> times, std::vector<double> values) {
  return {Kind::translation, interpolation, std::move(times), std::move(values)};
}

double x_at(const Motion& motion, double seconds) {
  return matrix_at(motion, seconds).translation().x;
}

/// The quaternion of a rotation about Y.
std::vector<double> about_y(double degrees) {
  const double half = degrees * kPi / 360;
  return {0, std::sin(half), 0, std::cos(half)};
}

double degrees_about_y(const Matrix4& rotation) {
  return std::atan2(-rotation[0][2], rotation[0][0]) * 180 / kPi;  // rotation of +X towards -Z
}

TEST(Motion, IsLinearBetweenKeyframesAndConstantOutside) {
  const Motion motion = translation(Interpolation::linear, {1, 3}, {10, 0, 0, 20, 0, 0});
  EXPECT_EQ(x_at(motion, 0), 10);
  EXPECT_EQ(x_at(motion, 1), 10);
  EXPECT_DOUBLE_EQ(x_at(motion, 1.5), 12.5);
  EXPECT_EQ(x_at(motion, 3), 20);
  EXPECT_EQ(x_at(motion, 99), 20);
}

TEST(Motion, StepsAtKeyframes) {
  const Motion motion = translation(Interpolation::step, {1, 2, 3}, {1, 0, 0, 2, 0, 0, 3, 0, 0});
  EXPECT_EQ(x_at(motion, 0), 1);
  EXPECT_EQ(x_at(motion, 1.999), 1);
  EXPECT_EQ(x_at(motion, 2), 2);
  EXPECT_EQ(x_at(motion, 4), 3);
}

TEST(Motion, SplinesReproduceACubic) {
  // x = t^3 at 0 and 2 s with its derivatives, 0 and 12; the outer tangents are unused.
  const Motion motion =
      translation(Interpolation::cubic_spline, {0, 2}, {99, 0, 0, 0, 0, 0, 0, 0, 0, 12, 0, 0, 8, 0, 0, 99, 0, 0});
  for (const double t : {0.0, 0.3, 1.0, 1.7, 2.0}) EXPECT_NEAR(x_at(motion, t), t * t * t, 1e-12) << t;
  EXPECT_EQ(x_at(motion, -1), 0);
  EXPECT_EQ(x_at(motion, 3), 8);
}

TEST(Motion, RotatesUniformlyAlongTheShorterArc) {
  Motion motion{Kind::rotation, Interpolation::linear, {0, 1}, about_y(0)};
  std::vector<double> end = about_y(120);
  motion.values.insert(motion.values.end(), end.begin(), end.end());
  for (const double t : {0.1, 0.25, 0.5, 0.9}) EXPECT_NEAR(degrees_about_y(matrix_at(motion, t)), 120 * t, 1e-9) << t;
  for (int k = 4; k < 8; ++k) motion.values[k] *= -1;  // the same rotation
  EXPECT_NEAR(degrees_about_y(matrix_at(motion, 0.5)), 60, 1e-9);
}

TEST(Motion, UsesTheLastOfKeyframesAtOneTime) {
  const Motion motion = translation(Interpolation::linear, {1, 1, 2}, {1, 0, 0, 5, 0, 0, 6, 0, 0});
  EXPECT_EQ(x_at(motion, 1), 5);
  EXPECT_DOUBLE_EQ(x_at(motion, 1.5), 5.5);
}

TEST(Motion, OfZeroQuaternionsIsTheIdentity) {
  const Motion motion{Kind::rotation, Interpolation::linear, {0, 1}, std::vector<double>(8, 0.0)};
  EXPECT_EQ(matrix_at(motion, 0.5), Matrix4());
}

TEST(MovingCamera, HasTheProductOfItsFactorsWithoutScale) {
  Camera camera;
  Matrix4 parent;
  parent.setScale(2.0);
  camera.motion = {translation(Interpolation::linear, {0, 1}, {0, 0, 0, 4, 0, 0}), {Kind::fixed, {}, {}, {}}};
  camera.motion[1].values.assign(&parent[0][0], &parent[0][0] + 16);
  Matrix4 expected;
  expected.setTranslation(Vec3d(4, 0, 0));
  EXPECT_TRUE(to_world_at(camera, 0.5)->equalWithAbsError(expected, 1e-12));
}

TEST(MovingCamera, HasNoFrameWhereItsTransformIsDegenerate) {
  Camera camera;
  camera.motion = {{Kind::scale, Interpolation::linear, {0, 2}, {1, 1, 1, 1, 1, -1}}};
  EXPECT_TRUE(to_world_at(camera, 0).has_value());
  EXPECT_FALSE(to_world_at(camera, 1).has_value());
}

}  // namespace
}  // namespace patchlight
