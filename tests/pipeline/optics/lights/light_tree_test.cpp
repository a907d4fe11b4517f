#include "pipeline/optics/lights/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/sampling/random.h"

namespace patchlight {
namespace {

double random_at(int k) {
  return double(uniform01(hash64(std::uint64_t(k))));
}

/// Facets of all orientations and sizes in a cube of 4 m.
std::vector<LightBounds> random_lights(int count) {
  std::vector<LightBounds> lights;
  for (int k = 0; k < count; ++k) {
    const auto random = [&](int i) { return 2 * random_at(16 * k + i) - 1; };
    const double size = 0.01 + 0.1 * random_at(16 * k + 9);
    const Vec3d axis = Vec3d(random(3), random(4), random(5)).normalized();
    const bool sphere = k % 5 == 0;
    lights.push_back(
        {Vec3d(random(0), random(1), random(2)) * 2.0, size, axis, sphere ? kPi : 0.0, (sphere ? 4 : 1) * size * size});
  }
  return lights;
}

/// Irradiance of a small emitter of exitance 1, times pi. A sphere shows a quarter of its surface.
double irradiance(const LightBounds& light, const Vec3d& point, const Vec3d& normal) {
  const Vec3d to = light.center - point, direction = to.normalized();
  const double emitted = light.angle > 0 ? 0.25 : std::max(0.0, -(direction ^ light.axis));
  return light.area * emitted * std::max(0.0, direction ^ normal) / to.length2();
}

TEST(LightTree, GivesTheSumOverAllEmittersInTheMean) {
  const Vec3d normal = Vec3d(0.3, 1, 0.2).normalized();
  for (const int count : {1, 2, 33, 1000})
    for (const Vec3d& point : {Vec3d(0, -3, 0), Vec3d(0.4, 0.1, -0.3), Vec3d(9, 2, 5)}) {
      const std::vector<LightBounds> lights = random_lights(count);
      const LightTree tree(lights);
      double exact = 0, mean = 0;
      for (const LightBounds& light : lights) exact += irradiance(light, point, normal);
      LightTree::Cut cut(tree, {point, 0.0, normal});
      constexpr int kSets = 2000, kSamples = 16;
      for (int set = 0; set < kSets; ++set)
        for (const auto& [emitter, probability] : cut.choose(kSamples, random_at(set)))
          if (probability > 0) mean += irradiance(lights[emitter], point, normal) / (probability * kSamples * kSets);
      EXPECT_NEAR(mean, exact, 0.02 * exact + 1e-12) << count << " " << point;
    }
}

TEST(LightTree, ChoosesLittleElseThanWhatLightsFarReceivers) {
  const std::vector<LightBounds> lights = random_lights(1000);
  const LightTree tree(lights);
  const Vec3d point(0, -8, 0), normal(0, 1, 0);
  double exact = 0, worst = 0;
  for (const LightBounds& light : lights) exact += irradiance(light, point, normal);
  LightTree::Cut cut(tree, {point, 0.0, normal});
  for (int set = 0; set < 100; ++set) {
    double estimate = 0;
    for (const auto& [emitter, probability] : cut.choose(64, random_at(set)))
      if (probability > 0) estimate += irradiance(lights[emitter], point, normal) / (probability * 64);
    worst = std::max(worst, std::abs(estimate / exact - 1));
  }
  EXPECT_LT(worst, 0.15);
}

TEST(LightTree, ChoosesNothingThatFacesAway) {
  std::vector<LightBounds> lights;
  for (int k = 0; k < 100; ++k) lights.push_back({Vec3d(0.1 * k, 1, 0), 0.01, Vec3d(0, 1, 0), 0.0, 1e-4});
  const LightTree tree(lights);
  const auto probability = [&](const Vec3d& point, const Vec3d& normal) {
    double sum = 0;
    for (const LightTree::Choice& choice : LightTree::Cut(tree, {point, 0.0, normal}).choose(8, 0.5))
      sum += choice.probability;
    return sum;
  };
  EXPECT_EQ(probability({5, 0, 0}, {0, 1, 0}), 0) << "their unlit sides";
  EXPECT_EQ(probability({5, 2, 0}, {0, 1, 0}), 0) << "below the horizon";
  EXPECT_GT(probability({5, 2, 0}, {0, -1, 0}), 0);
  EXPECT_TRUE(LightTree::Cut(LightTree({}), {}).choose(8, 0.5).empty());
}

TEST(LightTree, KnowsTheProbabilityOfItsChoices) {
  for (const int count : {1, 9, 700}) {
    const LightTree tree(random_lights(count));
    const LightTree::Receiver receiver{{0.4, -3, -0.3}, 0.0, {0, 1, 0}};
    double sum = 0;
    for (std::int32_t i = 0; i < count; ++i) sum += tree.probability(i, receiver);
    EXPECT_LT(sum, 1 + 1e-6) << count;
    EXPECT_GT(sum, 0.98) << count << ": some nodes have no emitter that lights the receiver";
    for (int k = 0; k < 200; ++k) {
      const auto [emitter, probability] = tree.choose(receiver, (k + 0.5) / 200);
      if (probability == 0) continue;
      EXPECT_NEAR(tree.probability(emitter, receiver), probability, 1e-6 * probability);
    }
  }
}

}  // namespace
}  // namespace patchlight
