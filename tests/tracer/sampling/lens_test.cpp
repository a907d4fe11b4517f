#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

constexpr double kAperture = 0.2, kFocus = 4.0;

double sum_of(const Image& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0,
                         [](double sum, const Color& pixel) { return sum + double(pixel.y); });
}

/// Mean of the variances of an image's light along both axes, in pixels squared.
double variance(const Image& image) {
  double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
  const double sum = sum_of(image);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double part = double(image.pixels[std::size_t(y) * image.width + x].y) / sum;
      x1 += part * x;
      x2 += part * x * x;
      y1 += part * y;
      y2 += part * y * y;
    }
  return (x2 - x1 * x1 + y2 - y1 * y1) / 2;
}

/// A small bright sphere in the middle of a view of 100 x 100 pixels.
Solved bright_ball(double depth, Camera::Projection projection) {
  PatchScene builder;
  builder.sphere({0, 0, -depth}, 0.03 * depth / kFocus, 2, 4, {0.0f, 1.0f});
  Solved solved(builder);
  solved.job.trace.resolution = {100, 100};
  solved.job.trace.samples = 64;
  solved.camera.projection = projection;
  solved.camera.vertical =
      projection == Camera::Projection::perspective ? 2 * std::atan(0.4 / kFocus) : 0.4;  // 0.8 m at the focus
  return solved;
}

/// The light of a point is a disc of even brightness, whose variance along an axis is the square of its diameter over
/// 16. The variances of the sharp image and of the blur add up.
TEST(Lens, BlursAPointToItsCircleOfConfusion) {
  for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic})
    for (const double depth : {2.0, 3.0, 4.0, 5.5, 8.0}) {
      Solved solved = bright_ball(depth, projection);
      const Image sharp = solved.render();
      solved.camera.aperture = kAperture;
      solved.camera.focus = kFocus;
      const Image blurred = solved.render();
      const double at_object = projection == Camera::Projection::perspective ? depth : kFocus;
      const double expected = kAperture * std::abs(depth - kFocus) / at_object / 0.8 * 100;
      const double measured = 4 * std::sqrt(std::max(0.0, variance(blurred) - variance(sharp)));
      if (depth == kFocus)
        EXPECT_NEAR(variance(blurred), variance(sharp), 0.02 * variance(sharp));
      else
        EXPECT_NEAR(measured, expected, 0.02 * expected) << "depth " << depth;
      EXPECT_NEAR(sum_of(blurred), sum_of(sharp), 0.02 * sum_of(sharp)) << "depth " << depth;
    }
}

/// Seen through a lens that is open to one side of the edge of an emitter, at half the depth that is sharp.
struct BlurredEdge {
  static constexpr int kSize = 80;
  Solved solved;
  double radius;  ///< Of the circle of confusion, in pixels.

  static PatchScene builder() {
    PatchScene builder;
    builder.quad({{{-9, -9, -2}, {0, -9, -2}, {0, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.0f, float(kPi)});
    builder.quad({{{-9, -9, -6}, {9, -9, -6}, {9, 9, -6}, {-9, 9, -6}}}, 1, 1, {0.0f, 0.0f});
    return builder;
  }
  explicit BlurredEdge(PatchScene scene = builder()) : solved(scene) {
    solved.job.trace.resolution = {kSize, kSize};
    solved.job.trace.samples = 16;
    solved.camera.vertical = 2 * std::atan(0.4 / kFocus);
    solved.camera.aperture = 0.3;
    solved.camera.focus = kFocus;
    radius = 0.5 * 0.3 * (kFocus - 2) / 2 / 0.8 * kSize;
  }
  /// Part of a disc around `x` pixels to the right of the edge that is to its left.
  double covered(double x) const {
    const double t = std::clamp(x / radius, -1.0, 1.0);
    return (std::acos(t) - t * std::sqrt(1 - t * t)) / kPi;
  }
};

TEST(Lens, BlursAnEdgeEvenlyAndWithLittleNoise) {
  const BlurredEdge edge;
  const Image image = edge.solved.render();
  double squares = 0, bias = 0;
  int count = 0;
  for (int x = 0; x < BlurredEdge::kSize; ++x) {
    const double offset = x + 0.5 - BlurredEdge::kSize / 2;
    for (int y = 0; y < BlurredEdge::kSize; ++y) {
      const double value = double(image.pixels[std::size_t(y * BlurredEdge::kSize + x)].y);
      if (std::abs(offset) > edge.radius + 1) {
        EXPECT_NEAR(value, offset < 0 ? 1 : 0, 1e-5);
        continue;
      }
      const double error = value - edge.covered(offset);
      squares += error * error;
      bias += error;
      ++count;
    }
  }
  EXPECT_GT(count, 20 * BlurredEdge::kSize);
  EXPECT_LT(std::sqrt(squares / count), 0.02) << "random samples: 0.05";
  EXPECT_NEAR(bias / count, 0, 0.002);
}

/// A wall behind the focus, whose left half is white and lit. Its right half is dark and, with `shadow`, in the shadow
/// of what stands outside the view.
Solved half_lit_wall(bool shadow) {
  PatchScene builder;
  builder.quad({{{-9, -9, -6}, {0, -9, -6}, {0, 9, -6}, {-9, 9, -6}}}, 1, 1, {0.8f});
  builder.quad({{{0, -9, -6}, {9, -9, -6}, {9, 9, -6}, {0, 9, -6}}}, 1, 1, {shadow ? 0.001f : 0.8f});
  builder.get().primitives[0].smooth_vertices = {0, 1, 2, 3};
  builder.get().primitives[1].smooth_vertices = {1, 4, 5, 2};
  builder.quad({{{3.01, -0.01, 0}, {2.99, -0.01, 0}, {2.99, 0.01, 0}, {3.01, 0.01, 0}}}, 1, 1, {0.0f, 1e4f});
  if (shadow) builder.quad({{{1.5, -9, -3}, {9, -9, -3}, {9, 9, -3}, {1.5, 9, -3}}}, 1, 1, {0.0f});
  Solved solved(builder, 0, 0);
  solved.job.trace.resolution = {80, 80};
  solved.job.trace.samples = 16;
  solved.job.trace.quality = "direct";
  solved.camera.vertical = 2 * std::atan(0.4 / kFocus);
  solved.camera.aperture = 0.6;
  solved.camera.focus = kFocus;
  return solved;
}

/// Points of one pixel that lie far apart have each their own light: white where it is lit, not grey in half a shadow.
TEST(Lens, BlursReflectedLightAndNotReflectanceAndLightApart) {
  const Image lit = half_lit_wall(false).render(), half = half_lit_wall(true).render();
  const double radius = 0.5 * 0.6 * (6 - kFocus) / 6 / 0.8 * 80;
  for (int x = 0; x < 80; ++x) {
    double sum = 0, whole = 0;
    for (int y = 0; y < 80; ++y) {
      sum += double(half.pixels[std::size_t(y * 80 + x)].y);
      whole += double(lit.pixels[std::size_t(y * 80 + x)].y);
    }
    const double t = std::clamp((x + 0.5 - 40) / radius, -1.0, 1.0);
    EXPECT_NEAR(sum / whole, (std::acos(t) - t * std::sqrt(1 - t * t)) / kPi, 0.03) << "column " << x;
  }
}

TEST(Lens, GivesTheSameBitsOnAnyNumberOfThreads) {
  const BlurredEdge edge;
  const Image many = edge.solved.render();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(edge.solved.render().pixels, many.pixels);
}

TEST(Lens, LeavesDepthPositionAndPatchSharp) {
  BlurredEdge edge;
  edge.solved.job.trace.layers = {"albedo", "depth", "position", "patch"};
  for (const bool with_lens : {true, false}) {
    if (!with_lens) edge.solved.camera.aperture = 0;
    const Image image = edge.solved.render();
    const auto& depths = std::get<std::vector<float>>(image.layers[1].values);
    const auto& positions = std::get<std::vector<Color>>(image.layers[2].values);
    const auto& patches = std::get<std::vector<std::uint32_t>>(image.layers[3].values);
    for (int y = 0; y < BlurredEdge::kSize; ++y)
      for (int x = 0; x < BlurredEdge::kSize; ++x) {
        const auto at = std::size_t(y * BlurredEdge::kSize + x);
        const bool left = x < BlurredEdge::kSize / 2;
        EXPECT_NEAR(depths[at], left ? 2 : 6, 1e-5);
        EXPECT_NEAR(positions[at].z, left ? -2 : -6, 1e-5);
        EXPECT_EQ(patches[at], left ? 0u : 1u);
        if (!with_lens) continue;
        const double column = (x + 0.5) / BlurredEdge::kSize * 2 - 1;
        EXPECT_NEAR(positions[at].x, column * 0.4 / kFocus * depths[at], 1e-5) << "at the pixel's centre";
      }
  }
}

TEST(Lens, OfNoApertureCostsAndChangesNothing) {
  BlurredEdge edge;
  edge.solved.camera.aperture = 0;
  const Image with_focus = edge.solved.render();
  edge.solved.camera.focus = 0;
  EXPECT_EQ(edge.solved.render().pixels, with_focus.pixels);
}

}  // namespace
}  // namespace patchlight
