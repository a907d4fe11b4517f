#include "pipeline/optics/surface/coat_albedo.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/mirror.h"

namespace patchlight {
namespace {

/// Exact Fresnel reflectance of a dielectric (Born and Wolf 1999, section 1.5.2).
double fresnel(double ior, double cosine) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  const double s = (cosine - ior * inside) / (cosine + ior * inside);
  const double p = (ior * cosine - inside) / (ior * cosine + inside);
  return 0.5 * (s * s + p * p);
}

Coat coat_of(float ior, float strength) {
  const float root = (ior - 1) / (ior + 1);
  return {Color(strength * root * root), strength, ior};
}

SpecularProperties properties(const Coat& coat, float roughness) {
  return {Color(0.0f), roughness, coat.normal, coat.grazing, coat.ior};
}

/// The albedo of GGX facets with Fresnel's reflectance, by an integral over the outgoing hemisphere.
double integrated_albedo(const SpecularProperties& specular, double cosine) {
  constexpr int kSteps = 600;
  const Vec3f in(float(std::sqrt(1 - cosine * cosine)), 0, float(-cosine));
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double z = (i + 0.5) / kSteps, turn = 2 * kPi * (j + 0.5) / kSteps, r = std::sqrt(1 - z * z);
      const Vec3f out(float(r * std::cos(turn)), float(r * std::sin(turn)), float(z));
      const double half = std::sqrt(0.5 * (1 - double(in ^ out)));
      sum += double(specular_lobe(specular.roughness, {0, 0, 1}, in, out).value) *
             double(specular.reflectance(float(half)).x);
    }
  return sum * 2 * kPi / (kSteps * kSteps);
}

TEST(Fresnel, RisesAsTheExactFormula) {
  for (const double ior : {1.1, 1.33, 1.5, 2.4})
    for (const double cosine : {1.0, 0.8, 0.5, 0.2, 0.05}) {
      const double least = fresnel(ior, 1);
      EXPECT_NEAR(fresnel_rise(float(ior), float(cosine)), (fresnel(ior, cosine) - least) / (1 - least), 1e-5);
    }
  EXPECT_NEAR(fresnel_rise(0, 0.5f), std::pow(0.5, 5), 1e-6) << "Schlick's";
}

TEST(CoatAlbedos, AreThoseOfTheirFacets) {
  for (const float ior : {1.33f, 1.5f, 0.0f})
    for (const float strength : {1.0f, 0.5f}) {
      PatchSet scene;
      scene.materials = {{"bare"}, {"coated"}};
      scene.materials[1].coat = coat_of(1.5f, strength);
      scene.materials[1].coat.ior = ior;
      const CoatAlbedos albedos(scene);
      ASSERT_TRUE(albedos.any());
      for (const float roughness : {0.35f, 0.57f, 1.0f})
        for (const float cosine : {0.97f, 0.6f, 0.3f, 0.12f}) {
          const SpecularProperties specular = properties(scene.materials[1].coat, roughness);
          EXPECT_NEAR(albedos.at(specular, cosine).y, integrated_albedo(specular, double(cosine)), 0.003)
              << ior << ' ' << roughness << ' ' << cosine;
        }
    }
}

TEST(CoatAlbedos, OfMirrorsAreFresnels) {
  PatchSet scene;
  scene.materials = {{"coated"}};
  scene.materials[0].coat = coat_of(1.5f, 1.0f);
  const CoatAlbedos albedos(scene);
  const SpecularProperties specular = properties(scene.materials[0].coat, 0.0f);
  double mean = 0;
  for (int k = 0; k < 1000; ++k) {
    const double cosine = (k + 0.5) / 1000;
    EXPECT_NEAR(albedos.at(specular, float(cosine)).x, fresnel(1.5, cosine), 1e-4);
    mean += 2 * cosine * fresnel(1.5, cosine) / 1000;
  }
  EXPECT_NEAR(mean, 0.0918, 1e-4) << "of an index of 1.5, as known";
  EXPECT_NEAR(albedos.mean(specular).x, mean, 2e-4);
}

TEST(CoatAlbedos, AreReflectedOnAverage) {
  PatchSet scene;
  scene.materials = {{"coated"}};
  scene.materials[0].coat = coat_of(1.5f, 1.0f);
  const CoatAlbedos albedos(scene);
  for (const float roughness : {0.0f, 0.3f, 0.8f}) {
    const SpecularProperties specular = properties(scene.materials[0].coat, roughness);
    double sum = 0;
    constexpr std::uint32_t kRays = 1 << 14;
    for (std::uint32_t k = 0; k < kRays; ++k) {
      Vec3f direction(0.8f, 0, -0.6f);
      Color throughput(1.0f);
      if (reflect(specular, {0, 0, 1}, {(float(k) + 0.5f) / kRays, radical_inverse(k)}, direction, throughput))
        sum += double(throughput.x);
    }
    EXPECT_NEAR(sum / kRays, albedos.at(specular, 0.6f).x, 0.002) << roughness;
  }
}

TEST(CoatAlbedos, CostNothingWithoutCoats) {
  PatchSet scene;
  scene.materials = {{"bare"}, {"metal", Color(0.5f), 0.2f}};
  EXPECT_FALSE(CoatAlbedos(scene).any());
}

}  // namespace
}  // namespace patchlight
