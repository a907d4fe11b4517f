#include "tracer/sampling/outlines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr int kSize = 20;

/// Outlines for a camera at the origin that sees from -1 to 1 at distance 1.
std::vector<float> draw(const PatchSet& scene) {
  Camera camera;
  camera.vertical = kPi / 2;
  return Outlines(scene, SmoothEdges(scene.primitives)).draw(CameraRays(camera, kSize, kSize), kSize, kSize);
}

int edge_pixels(const std::vector<float>& depths) {
  return int(std::count_if(depths.begin(), depths.end(), [](float depth) { return std::isfinite(depth); }));
}

TEST(Outlines, PassThroughEveryPixelAlongAnEdge) {
  PatchScene builder;
  builder.quad({{{-0.55, -0.55, -1}, {0.55, -0.55, -1}, {0.55, 0.55, -1}, {-0.55, 0.55, -1}}}, 1, 1, {});
  const std::vector<float> depths = draw(builder.get());
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const bool across = x == 4 || x == 15, down = y == 4 || y == 15;
      const bool edge = (across && y >= 4 && y <= 15) || (down && x >= 4 && x <= 15);
      EXPECT_EQ(std::isfinite(depths[std::size_t(y * kSize + x)]), edge) << x << " " << y;
      if (edge) {
        EXPECT_NEAR(depths[std::size_t(y * kSize + x)], 1, 1e-5);
      }
    }
}

TEST(Outlines, HoldTheNearestEdgeAndThinSurfaces) {
  PatchScene builder;
  builder.quad({{{-4, -4, -2}, {4, -4, -2}, {4, 4, -2}, {-4, 4, -2}}}, 1, 1, {});  // its edges lie outside the view
  builder.quad({{{0.01, -9, -1}, {0.01001, -9, -1}, {0.01001, 9, -1}, {0.01, 9, -1}}}, 1, 1, {});
  builder.quad({{{0.04, -9, -2}, {0.5, -9, -2}, {0.5, 9, -2}, {0.04, 9, -2}}}, 1, 1, {});
  const std::vector<float> depths = draw(builder.get());
  for (int y = 0; y < kSize; ++y) EXPECT_NEAR(depths[std::size_t(y * kSize + 10)], 1, 1e-5);
}

TEST(Outlines, AreClippedAtTheCamera) {
  PatchScene builder;
  builder.quad({{{0.5, -1, 3}, {0.5, -1, -3}, {0.5, 1, -3}, {0.5, 1, 3}}}, 1, 1, {});  // beside the camera
  EXPECT_GT(edge_pixels(draw(builder.get())), 0);
  PatchScene behind;
  behind.quad({{{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}}}, 1, 1, {});
  EXPECT_EQ(edge_pixels(draw(behind.get())), 0);
}

TEST(Outlines, OfWhatTheCameraClipsAreNotDrawn) {
  PatchScene builder;
  builder.quad({{{-0.5, -0.5, -1}, {0.5, -0.5, -1}, {0.5, 0.5, -1}, {-0.5, 0.5, -1}}}, 1, 1, {});
  Camera camera;
  camera.vertical = kPi / 2;
  const auto count = [&](double znear, double zfar) {
    camera.znear = znear;
    camera.zfar = zfar;
    return edge_pixels(Outlines(builder.get(), SmoothEdges(builder.get().primitives))
                           .draw(CameraRays(camera, kSize, kSize), kSize, kSize));
  };
  EXPECT_GT(count(0.9, 1.1), 0);
  EXPECT_EQ(count(1.1, 2), 0);
  EXPECT_EQ(count(0, 0.9), 0);
}

TEST(Outlines, AreWidenedByALens) {
  constexpr int kFine = 200;
  const auto columns = [](double x, double depth, double focus) {
    PatchScene builder;
    builder.quad({{{x, -9, -depth}, {x + 99, -9, -depth}, {x + 99, 9, -depth}, {x, 9, -depth}}}, 1, 1, {});
    Camera camera;
    camera.vertical = kPi / 2;
    camera.aperture = 0.4;
    camera.focus = focus;
    const auto depths = Outlines(builder.get(), SmoothEdges(builder.get().primitives))
                            .draw(CameraRays(camera, kFine, kFine), kFine, kFine);
    return edge_pixels(depths) / kFine;
  };
  EXPECT_EQ(columns(0.001, 2, 2), 1);
  const double blur = 0.4 * (2 - 1) / 1 / 2 / 2 * kFine;  // of depth 1 at focus 2: 20 pixels
  EXPECT_GE(columns(0.001, 1, 2), blur);
  EXPECT_LE(columns(0.001, 1, 2), 1.5 * blur + 3);
  EXPECT_GE(columns(-1.05, 1, 2), blur / 4) << "an edge 5 pixels beside the image";
}

TEST(Outlines, OfSmoothSurfacesAreSilhouettes) {
  PatchScene builder;  // a roof whose ridge points at the camera
  builder.quad({{{-9, -9, -3}, {0, -9, -2}, {0, 9, -2}, {-9, 9, -3}}}, 1, 1, {});
  builder.quad({{{0, -9, -2}, {9, -9, -3}, {9, 9, -3}, {0, 9, -2}}}, 1, 1, {});
  EXPECT_EQ(edge_pixels(draw(builder.get())), kSize) << "a crease";
  builder.get().primitives[0].smooth_vertices = {0, 1, 2, 3};
  builder.get().primitives[1].smooth_vertices = {1, 4, 5, 2};
  EXPECT_EQ(edge_pixels(draw(builder.get())), 0);
  const Outlines outlines(builder.get(), SmoothEdges(builder.get().primitives));
  EXPECT_EQ(outlines.surface(0), outlines.surface(1));
  builder.get().primitives[1].corners = {Vec3d(0, -9, -2), Vec3d(-1, -9, -5), Vec3d(-1, 9, -5), Vec3d(0, 9, -2)};
  EXPECT_TRUE(std::isfinite(draw(builder.get())[5 * kSize + 10])) << "folded back behind the first";
}

TEST(Outlines, OfASphereAreItsSilhouette) {
  PatchScene builder;
  builder.sphere({0, 0, -2}, 1, 2, 4, {});
  const std::vector<float> depths = draw(builder.get());
  const double radius = kSize / 2 / std::sqrt(3.0);  // the tangent of asin(1/2), in pixels
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double distance = std::hypot(x + 0.5 - kSize / 2, y + 0.5 - kSize / 2);
      if (!std::isfinite(depths[std::size_t(y * kSize + x)])) continue;
      EXPECT_NEAR(distance, radius, 0.75);
      EXPECT_NEAR(depths[std::size_t(y * kSize + x)], 1.5, 1e-3);
    }
  EXPECT_GT(edge_pixels(depths), 2 * kPi * radius);
}

}  // namespace
}  // namespace patchlight
