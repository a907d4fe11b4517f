#include "solver/direct/light_samples.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "pipeline/optics/sampling/random.h"
#include "solver/solve.h"
#include "tests/alpha_mask_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// A floor, and above it lamps of 2 cm in random places, each of them a primitive.
PatchScene string_of_lamps(int count) {
  PatchScene builder;
  builder.quad({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}}, 16, 16, {0.5f});
  for (int k = 0; k < count; ++k) {
    const auto random = [&](int i) { return 4 * double(uniform01(hash64(std::uint64_t(4 * k + i)))) - 2; };
    const double x = random(0), z = random(1), y = 1.5, h = 0.01;
    builder.quad({{{x - h, y, z - h}, {x + h, y, z - h}, {x + h, y, z + h}, {x - h, y, z + h}}}, 1, 1, {0.0f, 100.0f});
  }
  return builder;
}

EnergyField solved(const PatchSet& scene, Transport& transport) {
  SolveConfig config;
  Progress progress({"test", true, ""});
  return solve(scene, config, transport, progress);
}

TEST(LightSamples, LightAFloorAsTheSumOfAllLampsDoes) {
  for (const int count : {65, 300, 2000}) {
    const PatchSet scene = string_of_lamps(count).get();
    const RayScene ray_scene(scene);
    Transport transport;
    const EnergyField energy = solved(scene, transport);
    std::vector<Emitter> all = explicit_emitters(scene);
    const std::vector<Emitter> further = further_emitters(scene);
    EXPECT_EQ(all.size(), 64u);
    EXPECT_EQ(further.size(), std::size_t(count) - 64);
    all.insert(all.end(), further.begin(), further.end());
    double square = 0, mean = 0;
    for (std::size_t i = 0; i < 256; ++i) {
      double exact = 0;
      for (const Emitter& emitter : all)
        exact += 100 * DirectLight(scene, ray_scene, emitter).form_factor(scene.patches[i].center, Vec3f(0, 1, 0));
      const double error = double(energy.groups[0].direct[i].y) / exact - 1;
      square += error * error / 256;
      mean += error / 256;
    }
    EXPECT_LT(std::sqrt(square), 0.02) << count;
    EXPECT_NEAR(mean, 0, 0.005) << count;
    ASSERT_TRUE(energy.display);
  }
}

TEST(LightSamples, ServeForOtherStrengthsWithoutARay) {
  PatchSet scene = string_of_lamps(200).get();
  Transport transport;
  const EnergyField before = solved(scene, transport);
  for (Patch& patch : scene.patches) patch.emission *= 3;
  const EnergyField after = solved(scene, transport);
  EXPECT_EQ(after.rays, 0);
  for (std::size_t i = 0; i < 256; ++i)
    EXPECT_NEAR(after.groups[0].direct[i].y, 3 * before.groups[0].direct[i].y, 1e-4 * after.groups[0].direct[i].y);
}

TEST(LightSamples, AreTheSameForAnyNumberOfThreads) {
  const PatchSet scene = string_of_lamps(200).get();
  Transport one, all;
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    solved(scene, one);
  }
  solved(scene, all);
  EXPECT_EQ(one.lights.starts, all.lights.starts);
  EXPECT_EQ(one.lights.patches, all.lights.patches);
  EXPECT_EQ(one.lights.weights, all.lights.weights);
  EXPECT_EQ(one.display->lights.weights, all.display->lights.weights);
}

TEST(LightSamples, OfLampsOfFacetsThatFaceAllWaysHaveLittleNoise) {
  PatchScene builder = string_of_lamps(0);
  constexpr double kRadius = 0.02;
  for (int k = 0; k < 200; ++k) {
    const auto random = [&](int i) { return 3 * double(uniform01(hash64(std::uint64_t(4 * k + i)))) - 1.5; };
    const Vec3d at(random(0), 1.5, random(1));
    for (int facet = 0; facet < 8; ++facet) {  // of an octahedron
      const Vec3d x = at + Vec3d(facet & 1 ? kRadius : -kRadius, 0, 0);
      const Vec3d y = at + Vec3d(0, facet & 2 ? kRadius : -kRadius, 0);
      const Vec3d z = at + Vec3d(0, 0, facet & 4 ? kRadius : -kRadius);
      const bool turned = (facet & 1) + (facet >> 1 & 1) + (facet >> 2) == 1 || facet == 7;
      builder.quad({x, turned ? y : z, turned ? z : y, turned ? z : y}, 1, 1, {0.0f, 100.0f});
    }
  }
  const PatchSet& scene = builder.get();
  const RayScene ray_scene(scene);
  Transport transport;
  const EnergyField energy = solved(scene, transport);
  std::vector<Emitter> all = explicit_emitters(scene);
  const std::vector<Emitter> further = further_emitters(scene);
  all.insert(all.end(), further.begin(), further.end());
  double square = 0;
  for (std::size_t i = 0; i < 256; ++i) {
    double exact = 0;
    for (const Emitter& emitter : all)
      exact += 100 * DirectLight(scene, ray_scene, emitter).form_factor(scene.patches[i].center, Vec3f(0, 1, 0));
    square += std::pow(double(energy.groups[0].direct[i].y) / exact - 1, 2) / 256;
  }
  EXPECT_LT(std::sqrt(square), 0.025);
}

TEST(LightSamples, OfAMaskedLampAreThoseOfItsSolidPart) {
  PatchScene builder = string_of_lamps(0);
  builder.quad({{{-0.2, 1.5, -0.2}, {0.2, 1.5, -0.2}, {0.2, 1.5, 0.2}, {-0.2, 1.5, 0.2}}}, 1, 1, {0.0f, 100.0f});
  const PatchSet solid = builder.get();
  test::alpha_masked(builder.get(), 1, test::checkers(14), 0.5f);
  const RayScene ray_scene(solid);
  const DirectLight lamp(solid, ray_scene, explicit_emitters(solid).at(0));
  Transport transport;
  const EnergyField energy = solved(builder.get(), transport);
  double square = 0, mean = 0;
  for (std::size_t i = 0; i < 256; ++i) {
    const double exact = 50 * lamp.form_factor(solid.patches[i].center, Vec3f(0, 1, 0));
    const double error = double(energy.groups[0].direct[i].y) / exact - 1;
    square += error * error / 256;
    mean += error / 256;
  }
  EXPECT_LT(std::sqrt(square), 0.12) << "by 128 rays, half of which pass through the mask";
  EXPECT_NEAR(mean, 0, 0.02);
}

TEST(LightSamples, PassNoWall) {
  PatchScene builder = string_of_lamps(200);
  builder.quad({{{-3, 0.5, -3}, {3, 0.5, -3}, {3, 0.5, 3}, {-3, 0.5, 3}}}, 1, 1, {0.0f});
  Transport transport;
  const EnergyField energy = solved(builder.get(), transport);
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(energy.groups[0].direct[i].y, 0);
}

}  // namespace
}  // namespace patchlight
