#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

TEST(Edges, AreTheCoveredFractionOfThePixel) {
  PatchScene builder;  // an emitter over the left 0.3 of the one pixel's width
  builder.quad({{{-1, -1, -1}, {-0.4, -1, -1}, {-0.4, 1, -1}, {-1, 1, -1}}}, 1, 1, {0.0f, float(kPi)});
  Solved solved(builder);
  solved.job.trace.resolution = {1, 1};
  solved.job.trace.samples = 256;
  solved.camera.vertical = kPi / 2;
  EXPECT_NEAR(solved.render().pixels[0].y, 0.3, 0.01);
}

/// An emitter of radiance 1 in the image plane, at distance 1, to the left of a slanted edge from x = `low` at the
/// bottom of the view to x = `high` at the top.
Solved slanted_edge(double low, double high, int size, int samples) {
  PatchScene builder;
  builder.quad({{{-3, -1, -1}, {low, -1, -1}, {high, 1, -1}, {-3, 1, -1}}}, 1, 1, {0.0f, float(kPi)});
  Solved solved(builder);
  solved.job.trace.resolution = {size, size};
  solved.job.trace.samples = samples;
  solved.camera.vertical = kPi / 2;
  return solved;
}

/// Exact fraction of a pixel to the left of the slanted edge.
double covered(double low, double high, int size, int x, int y) {
  constexpr int kFine = 64;
  double sum = 0;
  for (int j = 0; j < kFine; ++j) {
    const double up = 1 - (y + (j + 0.5) / kFine) / size;
    const double edge = ((low + (high - low) * up) + 1) / 2 * size;
    sum += std::clamp(edge - x, 0.0, 1.0) / kFine;
  }
  return sum;
}

TEST(Edges, AreAsGoodAsFourTimesTheSamplesUnderStratification) {
  constexpr int kSize = 40;
  for (const int samples : {4, 16, 64}) {
    const Image image = slanted_edge(-0.31, 0.42, kSize, samples).render();
    double squares = 0;
    int crossed = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double exact = covered(-0.31, 0.42, kSize, x, y), value = image.pixels[std::size_t(y * kSize + x)].y;
        if (exact <= 0 || exact >= 1) {
          EXPECT_NEAR(value, exact, 1e-5);
          continue;
        }
        squares += (value - exact) * (value - exact);
        ++crossed;
      }
    // An edge crosses about n of n x n strata, and only the samples in these err.
    const double sides = 2 * std::sqrt(double(samples));
    EXPECT_GT(crossed, 40);
    EXPECT_LT(std::sqrt(squares / crossed), 0.5 * std::pow(sides, -1.5)) << samples;
  }
}

TEST(Edges, OneSampleIsTakenInEveryPixel) {
  const Image image = slanted_edge(-0.31, 0.42, 40, 1).render();
  for (const Color& pixel : image.pixels) EXPECT_LT(std::min(std::abs(pixel.y), std::abs(pixel.y - 1)), 1e-5);
}

/// Rendered over exact light of a bright sliver, a hundredth of a pixel wide and as long as the image is high.
/// `shift`: in pixels.
double sliver_ratio(bool mirrored, double shift) {
  constexpr int kSize = 24;
  const double width = 2.0 / kSize / 100, low = -0.3 + shift * 2.0 / kSize, high = low + 0.5;
  PatchScene builder;
  const double z = mirrored ? 0 : -1;
  std::array<Vec3d, 4> corners{{{low, -1, z}, {low + width, -1, z}, {high + width, 1, z}, {high, 1, z}}};
  if (mirrored) {
    std::reverse(corners.begin(), corners.end());  // behind the camera, facing the mirror in front of it
    builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
    builder.quad({{{-9, -9, -0.5}, {9, -9, -0.5}, {9, 9, -0.5}, {-9, 9, -0.5}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  }
  builder.quad(corners, 1, 1, {0.0f, 100 * float(kPi)});
  Solved solved(builder);
  solved.job.trace.resolution = {kSize, kSize};
  solved.job.trace.samples = 16;
  solved.camera.vertical = kPi / 2;
  double sum = 0;
  for (const Color& pixel : solved.render().pixels) sum += pixel.y;
  return sum / kSize;
}

TEST(Edges, AThinBrightSliverIsUnbiased) {
  for (const bool mirrored : {false, true}) {
    constexpr int kFrames = 400;
    double mean = 0;
    for (int k = 0; k < kFrames; ++k) mean += sliver_ratio(mirrored, 3.7 * k / kFrames) / kFrames;
    EXPECT_NEAR(mean, 1, mirrored ? 0.15 : 0.04) << mirrored;  // about 3 standard deviations
  }
}

TEST(Edges, ASmoothImageIsExactWithFewSamples) {
  PatchScene builder;
  builder.quad({{{-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.8f, 0.0f});
  builder.quad({{{-1, -1, 3}, {-1, 1, 3}, {1, 1, 3}, {1, -1, 3}}}, 1, 1, {0.0f, 5.0f});
  Solved solved(builder, 7.0f, 1.0f);
  solved.job.trace.quality = "direct";
  solved.job.trace.resolution = {40, 40};
  solved.camera.vertical = 1.0;
  const RayScene ray_scene(solved.scene);
  const DirectLight lamp(solved.scene, ray_scene, explicit_emitters(solved.scene).at(0));
  const Image image = solved.render();
  const CameraRays rays(solved.camera, 40, 40);
  for (int k = 0; k < 40 * 40; ++k) {
    ImagePoints points;
    points.x[0] = float(k % 40) + 0.5f;
    points.y[0] = float(k / 40) + 0.5f;
    RayPacket packet;
    rays.generate(points, ray_scene, packet);
    const Vec3d at = Vec3d(packet.direction(0)) * (-2 / double(packet.direction(0).z));
    const double exact = 0.8 * (1 + 5 * lamp.form_factor(at, {0, 0, 1})) / kPi;
    EXPECT_NEAR(image.pixels[std::size_t(k)].y, exact, 2e-3 * exact);
  }
}

}  // namespace
}  // namespace patchlight
