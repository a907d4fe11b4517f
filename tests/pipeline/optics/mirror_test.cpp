#include "pipeline/optics/surface/mirror.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {
namespace {

const Vec3f kNormal = Vec3f(1, 2, -2) / 3.0f;

/// A direction towards the surface with cosine `mu`.
Vec3f incoming(float mu) {
  const Vec3f across = (kNormal % Vec3f(1, 0, 0)).normalized();
  return across * std::sqrt(1 - mu * mu) - kNormal * mu;
}

TEST(Mirror, PerfectMirrorsReflectAtTheSameAngle) {
  Vec3f direction = incoming(0.6f);
  const Vec3f before = direction;
  Color throughput(0.5f);
  EXPECT_TRUE(reflect({Color(0.8f, 0.4f, 0.0f), 0.0f}, kNormal, {0.3f, 0.6f}, direction, throughput));
  EXPECT_NEAR(direction ^ kNormal, 0.6, 1e-6);
  EXPECT_NEAR((direction - before).length(), 1.2, 1e-6);
  EXPECT_NEAR(throughput.x, 0.4, 1e-6);
  EXPECT_EQ(throughput.z, 0);
}

TEST(Mirror, RoughMetalsHaveTheAlbedoOfTheirMicrofacets) {
  struct Case {
    float roughness, mu, albedo;  // albedo: integral of D G2 / (4 cos cos) over the hemisphere
  };
  for (const Case& c : {Case{1.0f, 0.999f, 0.3065f}, Case{1.0f, 0.7f, 0.3792f}, Case{0.5f, 0.999f, 0.9119f}}) {
    double sum = 0;
    constexpr int kSamples = 100000;
    for (std::uint64_t k = 0; k < kSamples; ++k) {
      Vec3f direction = incoming(c.mu);
      Color throughput(1.0f);
      if (!reflect({Color(1.0f), c.roughness}, kNormal, kronecker2(k, 1), direction, throughput)) continue;
      ASSERT_GT(direction ^ kNormal, 0);
      ASSERT_NEAR(direction.length(), 1, 1e-5);
      ASSERT_LE(throughput.x, 1);
      sum += throughput.x;
    }
    EXPECT_NEAR(sum / kSamples, c.albedo, 0.006) << c.roughness << " " << c.mu;
  }
}

TEST(Mirror, SmoothMetalsReflectNearThePerfectDirection) {
  Vec3f perfect = incoming(0.5f);
  perfect -= kNormal * (2.0f * (kNormal ^ perfect));
  for (std::uint64_t k = 0; k < 100; ++k) {
    Vec3f direction = incoming(0.5f);
    Color throughput(1.0f);
    ASSERT_TRUE(reflect({Color(1.0f), 0.06f}, kNormal, kronecker2(k, 1), direction, throughput));
    EXPECT_GT(direction ^ perfect, 0.99f);
  }
}

TEST(Mirror, LobeIsTheDensityOfReflect) {
  for (const float roughness : {0.3f, 0.8f})
    for (const float mu : {0.95f, 0.3f}) {
      const Vec3f in = incoming(mu);
      const SpecularProperties metal{Color(1.0f), roughness};
      Vec3f tangent, bitangent;
      orthonormal_frame(kNormal, tangent, bitangent);
      // Integrals over the hemisphere, and over a part of it.
      double all = 0, value = 0, part = 0;
      constexpr int kGrid = 400;
      for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
          const double z = (i + 0.5) / kGrid, turn = 2 * kPi * (j + 0.5) / kGrid, r = std::sqrt(1 - z * z);
          const Vec3f out =
              tangent * float(r * std::cos(turn)) + bitangent * float(r * std::sin(turn)) + kNormal * float(z);
          const SpecularLobe lobe = specular_lobe(roughness, kNormal, in, out);
          const double solid_angle = 2 * kPi / (kGrid * kGrid);
          all += lobe.density * solid_angle;
          value += lobe.value * solid_angle;
          if ((out ^ tangent) > 0.3f) part += lobe.density * solid_angle;
        }
      double reflected = 0, sampled_value = 0, sampled_part = 0;
      constexpr int kSamples = 200000;
      for (std::uint64_t k = 0; k < kSamples; ++k) {
        Vec3f out = in;
        Color throughput(1.0f);
        if (!reflect(metal, kNormal, kronecker2(k, 1), out, throughput)) continue;
        reflected += 1.0 / kSamples;
        sampled_value += throughput.x / kSamples;
        if ((out ^ tangent) > 0.3f) sampled_part += 1.0 / kSamples;
        const SpecularLobe lobe = specular_lobe(roughness, kNormal, in, out);
        ASSERT_NEAR(lobe.value / lobe.density, throughput.x, 1e-4);
      }
      EXPECT_NEAR(all, reflected, 0.005) << roughness << " " << mu;
      EXPECT_NEAR(value, sampled_value, 0.005) << roughness << " " << mu;
      EXPECT_NEAR(part, sampled_part, 0.005) << roughness << " " << mu;
    }
}

}  // namespace
}  // namespace patchlight
