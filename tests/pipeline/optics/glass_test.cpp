#include "pipeline/optics/surface/glass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/mirror.h"
#include "pipeline/optics/transport/glass_path.h"
#include "tests/glass_scene.h"

namespace patchlight {
namespace {

using test::add_glass;
using test::add_level;
using test::add_veil;
using test::fresnel;
using test::PatchScene;

const Vec3f kUp(0, 1, 0);

Vec3f downwards(double cosine) {
  return {float(std::sqrt(1 - cosine * cosine)), -float(cosine), 0.0f};
}

SpecularProperties surface_of(const PatchSet& scene, int material) {
  SpecularProperties result;
  result.roughness = scene.materials[material].roughness;
  result.coat = scene.materials[material].coat.normal;
  result.coat_grazing = 1.0f;
  result.coat_ior = scene.materials[material].coat.ior;
  return result;
}

TEST(Glass, FollowsSnellAndFresnel) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), true);
  const Transmission& body = builder.get().materials[glass].transmission;
  const SpecularProperties surface = surface_of(builder.get(), glass);
  for (const double cosine : {1.0, 0.8, 0.3, 0.05}) {
    const GlassWays in = glass_ways(surface, body, kUp, false, {0.5f, 0.5f}, downwards(cosine));
    const double sine = std::sqrt(1 - cosine * cosine);
    EXPECT_NEAR(in.passage.x, sine / 1.5, 1e-6);
    EXPECT_NEAR(in.reflection.y, cosine, 1e-6);
    EXPECT_NEAR(in.reflected.x, fresnel(1.5, cosine), 1e-5);
    EXPECT_NEAR(in.passed.x, 1 - fresnel(1.5, cosine), 1e-5);
    const GlassWays out = glass_ways(surface, body, kUp, true, {0.5f, 0.5f}, in.passage);
    EXPECT_NEAR(out.passage.x, sine, 1e-5) << "parallel faces give the direction back";
    EXPECT_NEAR(out.reflected.x, in.reflected.x, 1e-4) << "Stokes: the same on both sides";
  }
  const GlassWays total = glass_ways(surface, body, kUp, true, {0.5f, 0.5f}, downwards(0.7));
  EXPECT_EQ(total.reflected, Color(1.0f));
  EXPECT_EQ(total.passed, Color(0.0f));
}

TEST(Glass, ThatIsRoughScattersWhatItPasses) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), false, 0.5f);
  const SpecularProperties surface = surface_of(builder.get(), glass);
  double passed = 0, reflected = 0, widest = 0;
  constexpr int kSamples = 4096;
  for (int k = 0; k < kSamples; ++k) {
    const GlassWays ways = glass_ways(surface, builder.get().materials[glass].transmission, kUp, false,
                                      kronecker2(std::uint64_t(k), 1), downwards(1.0));
    passed += double(ways.passed.x) / kSamples;
    reflected += double(ways.reflected.x) / kSamples;
    EXPECT_LE(ways.passage.y, 0);
    widest = std::max(widest, double(ways.passage.x));
  }
  EXPECT_GT(widest, 0.5);
  EXPECT_NEAR(reflected, 0.04, 0.01);
  EXPECT_NEAR(passed + reflected, 1, 1e-5);
}

/// What a vertical or slanted ray from y = 3 keeps on its way to y = 0.
Color kept(const PatchSet& scene, double cosine = 1.0, double distance = 3.0) {
  const RayScene ray_scene(scene);
  const Vec3f direction = downwards(cosine);
  RayPacket packet;
  packet.clear();
  packet.set_shadow(5, ray_scene.to_local(Vec3d(-3 * std::sqrt(1 - cosine * cosine) / cosine, 3, 0)), direction,
                    float(distance / cosine));
  EXPECT_TRUE(ray_scene.has_passable());
  EXPECT_EQ(ray_scene.occluded(packet), 0u);
  return ray_scene.transmittances(packet, 1u << 5)[5];
}

TEST(Transmittances, OfSheetsMultiply) {
  PatchScene builder;
  const int clear = add_glass(builder.get(), false);
  const int red = add_glass(builder.get(), false, 0.0f, 1.5f, {1.0f, 0.5f, 0.25f});
  add_level(builder, 0, 50, true, {0.5f});
  add_level(builder, 1, 50, true, {0.0f, 0.0f, 0, clear});
  add_level(builder, 2, 50, false, {0.0f, 0.0f, 0, red});
  for (const double cosine : {1.0, 0.5, 0.2}) {
    const double once = 1 - fresnel(1.5, cosine);
    const Color passed = kept(builder.get(), cosine, 2.999);
    EXPECT_NEAR(passed.x, once * once, 1e-5);
    EXPECT_NEAR(passed.y, 0.5 * once * once, 1e-5);
    EXPECT_NEAR(passed.z, 0.25 * once * once, 1e-5);
  }
  EXPECT_NEAR(kept(builder.get(), 1.0, 1.5).x, 0.96, 1e-5) << "ends before the second sheet";
}

TEST(Transmittances, OfPlatesCountAllReflectionsBetweenTheFaces) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), true);
  add_level(builder, 1.1, 50, true, {0.0f, 0.0f, 0, glass});
  add_level(builder, 1.0, 50, false, {0.0f, 0.0f, 0, glass});
  for (const double cosine : {1.0, 0.6, 0.2}) {
    const double r = fresnel(1.5, cosine);
    EXPECT_NEAR(kept(builder.get(), cosine).x, (1 - r) / (1 + r), 1e-4);
  }
  builder.get().materials[glass].transmission.absorption = {0.0f, 10.0f, 2.0f};
  const double cosine = 0.6, r = fresnel(1.5, cosine), path = 0.1 / std::sqrt(1 - (1 - 0.36) / 2.25);
  const double once = std::exp(-10 * path);
  EXPECT_NEAR(kept(builder.get(), cosine).y, (1 - r) * (1 - r) * once / (1 - r * r * once * once), 1e-4);
}

TEST(Transmittances, OfVeilsAreWhatTheyLeaveOpen) {
  PatchScene builder;
  const int veil = add_veil(builder.get(), 0.3f);
  for (const double y : {1.0, 2.0})
    builder.get().primitives[add_level(builder, y, 50, true, {0.5f, 0.0f, 0, veil})].mask = 0;
  EXPECT_NEAR(kept(builder.get()).y, 0.49, 1e-5);
}

TEST(Transmittances, OfWhatTurnsLightAreNothing) {
  PatchScene ball, block, rough;
  ball.sphere({0.2, 1.5, 0}, 0.5, 4, 8, {0.0f, 0.0f, 0, add_glass(ball.get(), true)});
  const int glass = add_glass(block.get(), true);
  add_level(block, 2, 1, true, {0.0f, 0.0f, 0, glass});
  add_level(block, 1, 1, false, {0.0f, 0.0f, 0, glass});
  add_level(rough, 1, 50, true, {0.0f, 0.0f, 0, add_glass(rough.get(), false, 0.3f)});
  for (PatchScene* builder : {&ball, &block, &rough}) EXPECT_EQ(kept(builder->get()), Color(0.0f));
}

TEST(PassByChance, KeepsTheWeightsOfClearGlass) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), true);
  add_level(builder, 1, 50, true, {0.0f, 0.0f, 0, glass});
  const RayScene ray_scene(builder.get());
  int reflected = 0;
  constexpr int kRays = 4096;
  for (int k = 0; k < kRays; ++k) {
    RayPacket packet;
    packet.clear();
    packet.set(0, ray_scene.to_local({0, 2, 0}), downwards(0.2));
    ray_scene.intersect(packet, false);
    ASSERT_EQ(packet.passable, 1u);
    Color throughput(1.0f);
    const Passing passing = cross_by_chance(builder.get(), ray_scene, ray_scene.hit(packet, 0),
                                            hash64(std::uint64_t(k)), 0, packet, throughput);
    EXPECT_EQ(throughput, Color(1.0f));
    ASSERT_TRUE(passing == Passing::reflected || passing == Passing::passed);
    EXPECT_EQ(packet.direction(0).y > 0, passing == Passing::reflected);
    reflected += passing == Passing::reflected;
  }
  EXPECT_NEAR(double(reflected) / kRays, fresnel(1.5, 0.2), 0.02);
}

TEST(PassStraight, LeavesTheHitsBehind) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), false, 0.0f, 1.5f, {0.5f, 1.0f, 1.0f});
  const int floor = add_level(builder, 0, 5, true, {0.5f});
  add_level(builder, 1, 5, true, {0.0f, 0.0f, 0, glass});
  const RayScene ray_scene(builder.get());
  RayPacket packet;
  packet.clear();
  packet.set(2, ray_scene.to_local({0, 2, 0}), downwards(1.0));
  packet.set(3, ray_scene.to_local({0, 0.5, 0}), downwards(1.0));
  ray_scene.intersect(packet, false);
  std::array<Color, RayPacket::kSize> throughput;
  throughput.fill(Color(1.0f));
  pass_straight(builder.get(), ray_scene, packet, throughput, false);
  EXPECT_EQ(ray_scene.hit(packet, 2).primitive, floor);
  EXPECT_EQ(ray_scene.hit(packet, 3).primitive, floor);
  EXPECT_NEAR(throughput[2].x, 0.48, 1e-5);
  EXPECT_EQ(throughput[3], Color(1.0f));
}

}  // namespace
}  // namespace patchlight
