#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

/// A square across the view, of a radiance of its own, with its lit side or its back to the camera.
void add_screen(PatchScene& builder, double depth, float radiance, bool back = false, int material = 0) {
  const double half = 9, z = -depth;
  std::array<Vec3d, 4> corners{{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}};
  if (back) std::swap(corners[1], corners[3]);
  builder.quad(corners, 1, 1, {0.0f, radiance * float(kPi), 0, material});
}

/// Radiance in the middle and in the corner of the image, which must be the same.
float radiance(const Solved& solved) {
  const Image image = solved.render();
  EXPECT_NEAR(image.pixels.front().y, image.pixels[image.pixels.size() / 2 + 4].y, 1e-5f);
  return image.pixels.front().y;
}

TEST(Clip, CutsByDepthAlongTheAxis) {
  for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic})
    for (const double aperture : {0.0, 0.1}) {
      PatchScene builder;
      add_screen(builder, 1, 1);
      add_screen(builder, 2, 2);
      Solved solved(builder);
      Camera& camera = solved.camera;
      camera.projection = projection;
      camera.vertical = 1.5;
      camera.aperture = aperture;
      camera.focus = 1.5;
      EXPECT_NEAR(radiance(solved), 1, 1e-5);
      camera.znear = 0.999;
      EXPECT_NEAR(radiance(solved), 1, 1e-5);
      camera.znear = 1.001;
      EXPECT_NEAR(radiance(solved), 2, 1e-5);
      camera.zfar = 2.001;
      EXPECT_NEAR(radiance(solved), 2, 1e-5);
      camera.zfar = 1.999;
      EXPECT_EQ(radiance(solved), 0);
    }
}

TEST(Clip, HoldsBehindBacksThatAreLookedThrough) {
  PatchScene builder;
  add_screen(builder, 1, 0, true);
  add_screen(builder, 2, 2);
  Solved solved(builder);
  solved.job.trace.cull_backfaces = true;
  solved.camera.vertical = 1.5;
  solved.camera.zfar = 2.001;
  EXPECT_NEAR(radiance(solved), 2, 1e-5);
  solved.camera.zfar = 1.999;
  EXPECT_EQ(radiance(solved), 0);
}

TEST(Clip, IsOfCameraRaysAlone) {
  PatchScene builder;  // a mirror shows what is behind the camera and farther than zfar
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  add_screen(builder, 1, 0, false, 1);
  add_screen(builder, -9, 3, true);
  Solved solved(builder);
  solved.camera.vertical = 0.5;
  solved.camera.znear = 0.9;
  solved.camera.zfar = 1.1;
  EXPECT_NEAR(radiance(solved), 3, 1e-5);
}

TEST(Clip, LeavesNothingInTheDepthLayer) {
  PatchScene builder;
  add_screen(builder, 2, 2);
  Solved solved(builder);
  solved.job.trace.layers = {"depth"};
  solved.camera.zfar = 1.5;
  EXPECT_EQ(std::get<std::vector<float>>(solved.render().layers[0].values)[0], 1e10f);
}

}  // namespace
}  // namespace patchlight
