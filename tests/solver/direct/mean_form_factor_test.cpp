#include "solver/direct/mean_form_factor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// By midpoint quadrature with very many points.
double dense_mean(const DirectLight& light, const PatchSet& scene) {
  constexpr int kSide = 800;
  const PatchSampler sampler(scene.primitives, scene.patches[0]);
  double sum = 0;
  for (int k = 0; k < kSide * kSide; ++k) {
    const SurfacePoint at = sampler((float(k % kSide) + 0.5f) / kSide, (float(k / kSide) + 0.5f) / kSide);
    sum += light.form_factor(at.position, at.normal);
  }
  return sum / (kSide * kSide);
}

double mean(const DirectLight& light, const PatchSet& scene) {
  const PatchSampler sampler(scene.primitives, scene.patches[0]);
  return mean_form_factor(light, scene.patches[0], sampler, nullptr);
}

TEST(MeanFormFactor, HoldsHoweverNearTheLightIs) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 1, 1, {0.5f});
  for (const double height : {0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 50.0}) {
    const DirectLight point(test::light_at({0.3, height, 0.2}));
    EXPECT_NEAR(mean(point, builder.get()) / dense_mean(point, builder.get()), 1, 0.002) << "point at " << height;
    PatchScene lit = builder;
    lit.quad({{{0.2, height, 0.1}, {0.4, height, 0.1}, {0.4, height, 0.4}, {0.2, height, 0.4}}}, 1, 1, {0.0f, 1.0f});
    const RayScene ray_scene(lit.get());
    const DirectLight lamp(lit.get(), ray_scene, explicit_emitters(lit.get()).at(0));
    EXPECT_NEAR(mean(lamp, lit.get()) / dense_mean(lamp, lit.get()), 1, 0.002) << "lamp at " << height;
  }
}

}  // namespace
}  // namespace patchlight
