#include "tracer/pixel_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr int kWidth = 8, kPerPixel = 16;

/// A lamp of a metre square above the ground, and a tile that looks at a strip of ground of the width of `extent`.
struct Ground {
  PatchScene builder;
  double extent;

  explicit Ground(double wide) : extent(wide) {
    builder.quad({{{-0.5, 2, -0.5}, {0.5, 2, -0.5}, {0.5, 2, 0.5}, {-0.5, 2, 0.5}}}, 2, 2, {0.0f, 3.0f});
    builder.quad({{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}}, 1, 1, {0.5f, 0.0f});
  }

  /// x of sample k of a pixel.
  double x(int pixel, int k) const { return extent * ((pixel + (k + 0.5) / kPerPixel) / kWidth - 0.5); }

  std::vector<Color> light(std::uint64_t seed, const Color& setting = Color(1.0f)) {
    const PatchSet& scene = builder.get();
    const RayScene rays(scene);
    std::vector<Color> emission, pixels(kWidth, Color(0.0f));
    for (const Patch& patch : scene.patches) emission.push_back(patch.emission * setting);
    std::vector<ShadingPoint> points;
    for (int k = 0; k < kPerPixel; ++k)
      for (std::uint32_t pixel = 0; pixel < kWidth; ++pixel)
        points.push_back({pixel, 1, Vec3d(x(int(pixel), k), 1e-6, 0.1), Vec3f(0, 1, 0), Color(1.0f / kPerPixel)});
    PixelLight(scene, rays, emission).add(points, kWidth, seed, pixels);
    return pixels;
  }
};

TEST(PixelLight, OfALampThatNothingHidesIsItsClosedForm) {
  Ground ground(0.5);
  const RayScene rays(ground.builder.get());
  const DirectLight lamp(ground.builder.get(), rays, emitters_apart(ground.builder.get()).at(0));
  const std::vector<Color> pixels = ground.light(1);
  for (int p = 0; p < kWidth; ++p) {
    double exact = 0;
    for (int k = 0; k < kPerPixel; ++k)
      exact += 3 * lamp.form_factor({ground.x(p, k), 1e-6, 0.1}, {0, 1, 0}) / kPerPixel;
    EXPECT_NEAR(pixels[p].y, exact, 3e-4 * exact);
  }
}

TEST(PixelLight, InPenumbraeIsRightInTheMean) {
  Ground ground(1.5);
  ground.builder.quad({{{0, 1, -2}, {0, 1, 2}, {4, 1, 2}, {4, 1, -2}}}, 1, 1, {0.0f, 0.0f});
  const RayScene rays(ground.builder.get());
  const DirectLight lamp(ground.builder.get(), rays, emitters_apart(ground.builder.get()).at(0));
  std::vector<double> mean(kWidth, 0.0), exact(kWidth, 0.0);
  constexpr int kSeeds = 200, kFine = 64;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const std::vector<Color> pixels = ground.light(std::uint64_t(seed));
    for (int p = 0; p < kWidth; ++p) mean[p] += pixels[p].y / kSeeds;
  }
  // What the shade leaves free of the lamp, by brute force.
  for (int p = 0; p < kWidth; ++p)
    for (int k = 0; k < kPerPixel; ++k)
      for (int i = 0; i < kFine * kFine; ++i) {
        const Vec3d at(ground.x(p, k), 1e-6, 0.1);
        const Vec3d to(-0.5 + (i % kFine + 0.5) / kFine, 2, -0.5 + (i / kFine + 0.5) / kFine);
        if (0.5 * (at.x + to.x) > 0) continue;
        const Vec3d d = to - at;
        exact[p] += 3 * d.y * d.y / (kPi * d.length2() * d.length2()) / (kFine * kFine * kPerPixel);
      }
  for (int p = 0; p < kWidth; ++p) EXPECT_NEAR(mean[p], exact[p], 0.003) << p;
  EXPECT_GT(exact[0], 0.15);
  EXPECT_LT(exact[kWidth - 1], 0.01);
}

TEST(PixelLight, FollowsTheSettingsOfTheLights) {
  Ground ground(0.5);
  const std::vector<Color> full = ground.light(1), dim = ground.light(1, Color(0.5f, 0.25f, 0.0f));
  EXPECT_NEAR(dim[3].x, 0.5f * full[3].x, 1e-6);
  EXPECT_NEAR(dim[3].y, 0.25f * full[3].y, 1e-6);
  EXPECT_EQ(dim[3].z, 0);
  EXPECT_EQ(ground.light(1, Color(0.0f))[3], Color(0.0f));
}

TEST(PixelLight, ALampDoesNotLightItself) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 2, 2, {0.5f, 3.0f});
  builder.sphere({0, 0, 5}, 1, 4, 8, {0.5f, 3.0f});
  const PatchSet& scene = builder.get();
  const RayScene rays(scene);
  const std::vector<Color> emission(scene.patches.size(), Color(3.0f));
  std::vector<Color> pixels(2, Color(0.0f));
  std::vector<ShadingPoint> points{{0, 0, Vec3d(0.3, 0.4, 1e-5), Vec3f(0, 0, 1), Color(1.0f)},
                                   {1, 1, Vec3d(0, 0, 6 + 1e-4), Vec3f(0, 0, 1), Color(1.0f)}};
  PixelLight(scene, rays, emission).add(points, 2, 1, pixels);
  EXPECT_GT(pixels[0].y, 0) << "the sphere lights the square";
  EXPECT_EQ(pixels[1].y, 0) << "the sphere's far side sees nothing";
}

}  // namespace
}  // namespace patchlight
