#include "solver/linear/irradiance_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr int kSide = 32;
const std::array<Vec3d, 4> kSquare{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};

std::vector<FilterGrid> grids_of(const PatchSet& scene) {
  const PatchLookup lookup(scene);
  return filter_grids(scene, lookup, Lattices(scene, lookup));
}

/// A field over a square of patches, and two noisy sample sets of it.
struct Sampled {
  PatchScene scene;
  SpectrumField truth, mean, deviation, reflectance;

  template <class Field>
  Sampled(Field field, double noise, unsigned seed = 7) {
    scene.quad(kSquare, kSide, kSide, {0.5f, 0.0f});
    std::mt19937 random(seed);
    std::normal_distribution<double> scatter(0, noise);
    for (const Patch& patch : scene.get().patches) {
      const double exact = field(patch.center.x, patch.center.y);
      const double a = exact + scatter(random), b = exact + scatter(random);
      truth.emplace_back(exact);
      mean.emplace_back(0.5 * (a + b));
      deviation.emplace_back(0.5 * (a - b));
      reflectance.emplace_back(patch.reflectance);
    }
  }

  IrradianceFilter filter() { return {grids_of(scene.get()), mean, deviation, reflectance, mean}; }

  double error(const SpectrumField& field) const {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += std::pow(field[i].c[1] - truth[i].c[1], 2);
    return std::sqrt(sum / double(truth.size()));
  }
};

double parabola(double x, double y) {
  return 2 + x - 3 * y + 2 * x * y - x * x + 0.5 * y * y;
}

TEST(IrradianceFilter, RemovesNoiseFromSmoothFields) {
  Sampled sampled(parabola, 0.1);
  EXPECT_LT(sampled.error(sampled.filter().apply(sampled.mean)), 0.25 * sampled.error(sampled.mean));
}

TEST(IrradianceFilter, PreservesParabolas) {
  Sampled sampled(parabola, 0.1);
  EXPECT_LT(sampled.error(sampled.filter().apply(sampled.truth)), 1e-12);
}

TEST(IrradianceFilter, PreservesEdges) {
  Sampled sampled([](double x, double y) { return x > 0.4 + 0.3 * y ? 1.0 : 0.1; }, 0.01);
  EXPECT_LT(sampled.error(sampled.filter().apply(sampled.mean)), 1.05 * sampled.error(sampled.mean));
}

TEST(IrradianceFilter, EstimatesItsBias) {
  double stated = 0, squares = 0, unfiltered = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    Sampled sampled([](double x, double y) { return 2 + std::sin(9 * x) * std::cos(8 * y); }, 0.2, seed);
    const IrradianceFilter filter = sampled.filter();
    const SpectrumField noise = filter.apply(sampled.deviation);
    for (std::size_t i = 0; i < noise.size(); ++i)
      stated += (filter.bias(i).square / 0.75 + std::pow(noise[i].c[1], 2)) / double(noise.size());
    squares += std::pow(sampled.error(filter.apply(sampled.mean)), 2);
    unfiltered += std::pow(sampled.error(sampled.mean), 2);
  }
  EXPECT_LT(squares, 0.3 * unfiltered);
  EXPECT_NEAR(stated / squares, 1.0, 0.3);  // 0.75: three channels of a reflectance of a half
}

TEST(IrradianceFilter, LeavesUnlitPatchesBlack) {
  Sampled sampled([](double x, double) { return x < 0.5 ? 0.0 : 3.0; }, 0.0);
  const SpectrumField smooth = sampled.filter().apply(sampled.mean);
  for (std::size_t i = 0; i < smooth.size(); ++i) EXPECT_EQ(smooth[i].c[1] == 0, sampled.truth[i].c[1] == 0);
}

TEST(IrradianceFilter, DoesNotFilterSmallGrids) {
  PatchScene builder;
  builder.quad(kSquare, 3, 2, {0.5f, 0.0f});
  const std::size_t n = builder.get().patches.size();
  SpectrumField mean, deviation, reflectance(n, Spectrum(0.5));
  for (std::size_t i = 0; i < n; ++i) {
    mean.emplace_back(double(i % 5));
    deviation.emplace_back(1.0);
  }
  const IrradianceFilter filter(grids_of(builder.get()), mean, deviation, reflectance, mean);
  const SpectrumField same = filter.apply(mean);
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(same[i].c[0], mean[i].c[0]);
}

}  // namespace
}  // namespace patchlight
