#include "solver/form_factors/sky_guide.h"

#include <gtest/gtest.h>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {
namespace {

/// `count` points of a rectangle whose second coordinate turns.
std::vector<Vec2f> points_in(const Vec2f& low, const Vec2f& size, int count, std::uint64_t seed) {
  std::vector<Vec2f> points;
  for (int k = 0; k < count; ++k) {
    const Vec2f at = low + kronecker2(std::uint64_t(k), seed) * size;
    points.emplace_back(at.x, at.y - std::floor(at.y));
  }
  return points;
}

TEST(SkyGuide, HoldsAWindowThatItKnowsAndLittleMore) {
  const Vec2f size(0.1f, 0.05f);
  for (const Vec2f& low : {Vec2f(0.5f, 0.5f), Vec2f(0.9f, 0.98f), Vec2f(0.0f, 0.0f)}) {
    const SkyGuide guide(points_in(low, size, 200, 1));
    for (const Vec2f& at : points_in(low, size, 10000, 2)) ASSERT_TRUE(guide.contains(at)) << at;
    EXPECT_LT(guide.area(), 2.5f * size.x * size.y);
  }
}

TEST(SkyGuide, HasThePointsThatItContainsUniformly) {
  std::vector<Vec2f> known = points_in({0.2f, 0.95f}, {0.05f, 0.1f}, 40, 1);
  for (const Vec2f& at : points_in({0.7f, 0.3f}, {0.3f, 0.02f}, 40, 2)) known.push_back(at);
  const SkyGuide guide(known);
  constexpr int kPoints = 20000;
  int contained = 0, inside = 0, upper = 0, upper_inside = 0;
  for (int k = 0; k < kPoints; ++k) {
    const Vec2f at = kronecker2(std::uint64_t(k), 3), mapped = guide.point(at);
    contained += guide.contains(at);
    upper += guide.contains(at) && at.x > 0.5f;
    inside += guide.contains(mapped);
    upper_inside += mapped.x > 0.5f;
  }
  EXPECT_NEAR(double(contained) / kPoints, guide.area(), 0.005);
  EXPECT_GT(inside, 0.999 * kPoints);  // but for rounding
  EXPECT_NEAR(double(upper_inside) / kPoints, double(upper) / contained, 0.02);
}

TEST(SkyGuide, ReachesFarAroundALoneDirection) {
  const Vec2f alone(0.5f, 0.25f);
  const SkyGuide guide({&alone, 1});
  EXPECT_TRUE(guide.contains({0.53f, 0.22f}));
  EXPECT_FALSE(guide.contains({0.6f, 0.25f}));
  EXPECT_NEAR(guide.area(), 1.0f / 256, 1e-5);
}

TEST(SkyGuide, TurnsDirectionsToOtherNormals) {
  const Vec3f from(0, 1, 0), to = Vec3f(1, 2, 3).normalized();
  const auto about = [](const Vec2f& at, const Vec3f& normal) {
    Vec3f tangent, bitangent;
    orthonormal_frame(normal, tangent, bitangent);
    const Vec3f d = cosine_direction(at.x, at.y);
    return tangent * d.x + bitangent * d.y + normal * d.z;
  };
  for (const Vec2f& at : points_in({0, 0}, {1, 1}, 100, 1)) {
    const Vec3f world = about(at, from);
    const Vec2f turned = turned_direction(at, from, to);
    if ((world ^ to) < 0)
      EXPECT_GT(turned.x, 1);
    else
      EXPECT_LT((about(turned, to) - world).length(), 2e-3);
  }
}

}  // namespace
}  // namespace patchlight
