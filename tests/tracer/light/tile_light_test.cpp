#include "tracer/light/lamps/tile_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/alpha_mask_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr int kWidth = 8, kPerPixel = 16;

/// Light of a row of pixels at `points`. `x0`: image column of the first pixel, which seeds the random numbers.
std::vector<Color> light_of(const PatchSet& scene, const Color& setting, std::vector<ShadingPoint> points, int width,
                            int x0) {
  const RayScene rays(scene);
  const ExplicitLights lights(scene, rays, {setting});
  const FurtherLight further(scene, rays, {setting});
  TileLight tile(lights, further, {x0, 0, width, 1}, kPerPixel);
  std::vector<Color> pixels(std::size_t(width), Color(0.0f));
  tile.probe(points, std::vector<std::uint8_t>(std::size_t(width), 1));
  std::erase_if(points, [&](const ShadingPoint& p) { return !tile.sharp(p.pixel) && tile.add_probed(p, pixels); });
  tile.add(points, pixels);
  return pixels;
}

/// A lamp of 1 m x 1 m above the ground, and a tile of one row of pixels that spans `extent` metres of the ground.
struct Ground {
  PatchScene builder;
  double extent;

  explicit Ground(double width) : extent(width) {
    builder.quad({{{-0.5, 2, -0.5}, {0.5, 2, -0.5}, {0.5, 2, 0.5}, {-0.5, 2, 0.5}}}, 2, 2, {0.0f, 3.0f});
    builder.quad({{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}}, 1, 1, {0.5f, 0.0f});
  }

  /// x coordinate of sample k of a pixel, m.
  double x(int pixel, int k) const { return extent * ((pixel + (k + 0.5) / kPerPixel) / kWidth - 0.5); }

  std::vector<Color> light(int x0, const Color& setting = Color(1.0f)) {
    std::vector<ShadingPoint> points;
    for (int k = 0; k < kPerPixel; ++k)
      for (std::uint32_t pixel = 0; pixel < kWidth; ++pixel)
        points.push_back(
            {pixel, 1, 1, {}, false, Vec3d(x(int(pixel), k), 1e-6, 0.1), Vec3f(0, 1, 0), Color(1.0f / kPerPixel)});
    return light_of(builder.get(), setting, points, kWidth, x0);
  }

  /// Mean of the pixels over some tiles, which have random numbers of their own.
  std::vector<double> mean_light(int tiles) {
    std::vector<double> mean(kWidth, 0.0);
    for (int tile = 0; tile < tiles; ++tile) {
      const std::vector<Color> pixels = light(9 * tile);
      for (int p = 0; p < kWidth; ++p) mean[p] += double(pixels[p].y) / tiles;
    }
    return mean;
  }

  /// Irradiance of a pixel by a grid of rays to each lamp, a square that faces down. `hidden(at, to)`: whether a ray is
  /// occluded.
  struct Lamp {
    Vec3d corner;
    double size, exitance;
  };
  template <typename Hidden>
  double brute_force(int pixel, const std::vector<Lamp>& lamps, Hidden&& hidden) const {
    constexpr int kFine = 64;
    double sum = 0;
    for (const Lamp& lamp : lamps)
      for (int k = 0; k < kPerPixel; ++k)
        for (int i = 0; i < kFine * kFine; ++i) {
          const Vec3d at(x(pixel, k), 1e-6, 0.1);
          const Vec3d to = lamp.corner + Vec3d(i % kFine + 0.5, 0, i / kFine + 0.5) * (lamp.size / kFine);
          if (hidden(at, to)) continue;
          const Vec3d d = to - at;
          sum += lamp.exitance * lamp.size * lamp.size * d.y * d.y / (kPi * d.length2() * d.length2());
        }
    return sum / (kFine * kFine * kPerPixel);
  }
};

TEST(TileLight, OfAnUnoccludedLampIsItsClosedForm) {
  Ground ground(0.5);
  const RayScene rays(ground.builder.get());
  const DirectLight lamp(ground.builder.get(), rays, explicit_emitters(ground.builder.get()).at(0));
  const std::vector<Color> pixels = ground.light(1);
  for (int p = 0; p < kWidth; ++p) {
    double exact = 0;
    for (int k = 0; k < kPerPixel; ++k)
      exact += 3 * lamp.form_factor({ground.x(p, k), 1e-6, 0.1}, {0, 1, 0}) / kPerPixel;
    EXPECT_NEAR(pixels[p].y, exact, 3e-4 * exact);
  }
}

TEST(TileLight, InPenumbraeIsUnbiased) {
  Ground ground(1.5);
  ground.builder.quad({{{0, 1, -2}, {0, 1, 2}, {4, 1, 2}, {4, 1, -2}}}, 1, 1, {0.0f, 0.0f});
  const RayScene rays(ground.builder.get());
  const DirectLight lamp(ground.builder.get(), rays, explicit_emitters(ground.builder.get()).at(0));
  const std::vector<Ground::Lamp> lamps{{{-0.5, 2, -0.5}, 1, 3}};
  const std::vector<double> mean = ground.mean_light(200);
  // The occluder covers x > 0 at half the lamp's height.
  const auto exact = [&](int p) {
    return ground.brute_force(p, lamps, [](const Vec3d& at, const Vec3d& to) { return at.x + to.x > 0; });
  };
  for (int p = 0; p < kWidth; ++p) EXPECT_NEAR(mean[p], exact(p), 0.004) << p;
  EXPECT_GT(exact(0), 0.15);
  EXPECT_LT(exact(kWidth - 1), 0.01);
}

TEST(TileLight, BehindASlitIsWhatComesThroughIt) {
  for (const double slit : {0.02, 0.004}) {
    Ground ground(0.4);
    const double h = 0.5 * slit;  // at half the lamp's height, so that a point sees a strip of twice the slit's width
    ground.builder.quad({{{h, 1, -4}, {h, 1, 4}, {4, 1, 4}, {4, 1, -4}}}, 1, 1, {0.0f, 0.0f});
    ground.builder.quad({{{-4, 1, -4}, {-4, 1, 4}, {-h, 1, 4}, {-h, 1, -4}}}, 1, 1, {0.0f, 0.0f});
    constexpr int kSide = 32, kTiles = 16, kPoints = 4;
    const auto x = [](int pixel) { return 0.4 * ((pixel % kSide + 0.5) / kSide - 0.5); };
    const auto z = [](int pixel) { return 0.4 * ((pixel / kSide + 0.5) / kSide - 0.5); };
    const RayScene rays(ground.builder.get());
    const ExplicitLights lights(ground.builder.get(), rays, {Color(1.0f)});
    const FurtherLight further(ground.builder.get(), rays, {Color(1.0f)});
    double mean = 0, exact = 0;
    int dark = 0;
    for (int tile = 0; tile < kTiles; ++tile) {
      std::vector<ShadingPoint> points;
      for (int pixel = 0; pixel < kSide * kSide; ++pixel)
        for (int k = 0; k < kPoints; ++k)
          points.push_back({std::uint32_t(pixel),
                            1,
                            1,
                            {},
                            false,
                            Vec3d(x(pixel), 1e-6, z(pixel)),
                            Vec3f(0, 1, 0),
                            Color(1.0f / kPoints)});
      TileLight light(lights, further, {tile * kSide, 0, kSide, kSide}, kPerPixel);
      std::vector<Color> pixels(kSide * kSide, Color(0.0f));
      light.probe(points, std::vector<std::uint8_t>(kSide * kSide, 1));
      for (const ShadingPoint& point : points) ASSERT_TRUE(light.add_probed(point, pixels));
      for (const Color& pixel : pixels) {
        mean += pixel.y;
        dark += pixel.y == 0;
      }
      for (int pixel = 0; pixel < kSide * kSide; ++pixel)
        for (int i = 0; i < 64; ++i) {  // a point at x sees the strip about -x
          const double along = (i + 0.5) / 64 - 0.5 - z(pixel), squared = 4 * x(pixel) * x(pixel) + 4 + along * along;
          exact += 3 * 2 * slit * 4 / (kPi * squared * squared) / 64;
        }
    }
    EXPECT_NEAR(mean / exact, 1, 0.03) << slit;
    EXPECT_LT(dark, 0.05 * kTiles * kSide * kSide) << slit;
  }
}

TEST(TileLight, OfFaintLampsAgreesWithBruteForce) {
  Ground ground(1.5);
  ground.builder.quad({{{0, 1, -2}, {0, 1, 2}, {4, 1, 2}, {4, 1, -2}}}, 1, 1, {0.0f, 0.0f});
  std::vector<Ground::Lamp> lamps{{{-0.5, 2, -0.5}, 1, 3}};
  for (const double x : {-4.0, -1.0, 0.5, 3.0}) {
    lamps.push_back({{x, 2.5, 0.7}, 0.5, 0.4});
    const double to = x + 0.5;
    ground.builder.quad({{{x, 2.5, 0.7}, {to, 2.5, 0.7}, {to, 2.5, 1.2}, {x, 2.5, 1.2}}}, 1, 1, {0.0f, 0.4f});
  }
  // Below the ground, and facing away: these do not contribute.
  ground.builder.quad({{{0, -1, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}}}, 1, 1, {0.0f, 9.0f});
  ground.builder.quad({{{0, 3, 0}, {0, 3, 1}, {1, 3, 1}, {1, 3, 0}}}, 1, 1, {0.0f, 9.0f});
  const std::vector<double> mean = ground.mean_light(100);
  for (int p = 0; p < kWidth; ++p) {
    const double exact = ground.brute_force(p, lamps, [](const Vec3d& at, const Vec3d& to) {
      return at.x + (to.x - at.x) / to.y > 0 && at.z + (to.z - at.z) / to.y < 2;
    });
    EXPECT_NEAR(mean[p], exact, 0.005) << p;
  }
}

/// A square of 12 x 12 small lamps, 1.9 m above the ground, instead of its lamp. The emitters that are explicitly
/// sampled are 64 larger ones below the ground.
std::vector<Ground::Lamp> many_lamps(Ground& ground) {
  std::vector<Ground::Lamp> lamps;
  for (Patch& patch : ground.builder.get().patches) patch.emission = Color(0.0f);
  for (int k = 0; k < 64; ++k)
    ground.builder.quad({{{0, -1, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}}}, 1, 1, {0.0f, 1.0f});
  for (int k = 0; k < 144; ++k) {
    const double x = 0.3 * (k % 12) - 1.7, z = 0.3 * (k / 12) - 1.7, to = 0.1;
    const float exitance = k % 7 == 0 ? 20.0f : 2.0f;
    lamps.push_back({{x, 1.9, z}, to, exitance});
    ground.builder.quad({{{x, 1.9, z}, {x + to, 1.9, z}, {x + to, 1.9, z + to}, {x, 1.9, z + to}}}, 1, 1,
                        {0.0f, exitance});
  }
  return lamps;
}

TEST(TileLight, OfManyUnoccludedLampsHasLittleNoise) {
  Ground ground(0.5);
  const std::vector<Ground::Lamp> lamps = many_lamps(ground);
  std::vector<double> exact;
  for (int p = 0; p < kWidth; ++p) exact.push_back(ground.brute_force(p, lamps, [](auto, auto) { return false; }));
  constexpr int kTiles = 20;
  double squares = 0;
  for (int tile = 0; tile < kTiles; ++tile) {
    const std::vector<Color> pixels = ground.light(9 * tile);
    for (int p = 0; p < kWidth; ++p) squares += std::pow(pixels[p].y / exact[p] - 1, 2) / (kTiles * kWidth);
  }
  EXPECT_LT(std::sqrt(squares), 0.01);
}

TEST(TileLight, OfManyLampsIsRightBehindOccluders) {
  Ground ground(1.5);
  ground.builder.quad({{{0, 1, -9}, {0, 1, 9}, {9, 1, 9}, {9, 1, -9}}}, 1, 1, {0.0f, 0.0f});
  const std::vector<Ground::Lamp> lamps = many_lamps(ground);
  const std::vector<double> mean = ground.mean_light(200);
  for (int p = 0; p < kWidth; ++p) {
    const double exact =
        ground.brute_force(p, lamps, [](const Vec3d& at, const Vec3d& to) { return at.x + (to.x - at.x) / to.y > 0; });
    EXPECT_NEAR(mean[p], exact, 0.01 * exact + 1e-4) << p;
  }
}

TEST(TileLight, OfAPictureIsThatOfItsPatches) {
  Ground ground(1.5);
  ground.builder.quad({{{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}}, 16, 16, {0.0f, 1.0f});
  std::vector<Ground::Lamp> lamps;
  PatchSet& scene = ground.builder.get();
  for (Patch& patch : scene.patches) {
    if (patch.primitive != 2) patch.emission = Color(0.0f);
    if (patch.primitive != 2) continue;
    const float exitance = patch.center.x > 0.3 && patch.center.z > 0 ? 30.0f : 1.0f;
    patch.emission = Color(exitance);
    lamps.push_back({patch.center - Vec3d(1.0 / 16, 0, 1.0 / 16), 1.0 / 8, exitance});
  }
  const std::vector<double> mean = ground.mean_light(50);
  for (int p = 0; p < kWidth; ++p) {
    const double exact = ground.brute_force(p, lamps, [](auto, auto) { return false; });
    EXPECT_NEAR(mean[p], exact, 0.01 * exact) << p;
  }
}

TEST(TileLight, OfAMaskedLampIsThatOfItsSolidPart) {
  Ground ground(1.5);
  PatchSet& scene = ground.builder.get();
  for (Patch& patch : scene.patches) patch.emission = Color(0.0f);
  ground.builder.quad({{{-0.2, 1, -0.2}, {0.2, 1, -0.2}, {0.2, 1, 0.2}, {-0.2, 1, 0.2}}}, 1, 1, {0.0f, 20.0f});
  test::alpha_masked(scene, 2, test::checkers(14), 0.5f);
  constexpr int kTiles = 200;
  double mean = 0, solid = 0;
  for (int tile = 0; tile < kTiles; ++tile)
    for (const Color& pixel : ground.light(9 * tile)) mean += pixel.y / kTiles;
  for (int p = 0; p < kWidth; ++p)
    solid += ground.brute_force(p, {{{-0.2, 1, -0.2}, 0.4, 20}}, [](auto, auto) { return false; });
  EXPECT_NEAR(mean, solid / 2, 0.008 * solid);
}

TEST(TileLight, FollowsTheSettingsOfTheLights) {
  Ground ground(0.5);
  const std::vector<Color> full = ground.light(1), dim = ground.light(1, Color(0.5f, 0.25f, 0.0f));
  EXPECT_NEAR(dim[3].x, 0.5f * full[3].x, 1e-6);
  EXPECT_NEAR(dim[3].y, 0.25f * full[3].y, 1e-6);
  EXPECT_EQ(dim[3].z, 0);
  EXPECT_EQ(ground.light(1, Color(0.0f))[3], Color(0.0f));
}

TEST(TileLight, ALampDoesNotLightItself) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 2, 2, {0.5f, 3.0f});
  builder.sphere({0, 0, 5}, 1, 4, 8, {0.5f, 3.0f});
  const std::vector<ShadingPoint> points{{0, 0, 0, {}, false, Vec3d(0.3, 0.4, 1e-5), Vec3f(0, 0, 1), Color(1.0f)},
                                         {1, 1, 1, {}, false, Vec3d(0, 0, 6 + 1e-4), Vec3f(0, 0, 1), Color(1.0f)}};
  const std::vector<Color> pixels = light_of(builder.get(), Color(1.0f), points, 2, 1);
  EXPECT_GT(pixels[0].y, 0) << "the sphere lights the square";
  EXPECT_EQ(pixels[1].y, 0) << "the square is hidden from the far side of the sphere";
}

}  // namespace
}  // namespace patchlight
