#include "tracer/light/integrator.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/surface/mirror.h"
#include "tests/alpha_mask_scene.h"
#include "tests/expect_error.h"
#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

TEST(Integrator, ShowsEmissionAndReflectedIrradiance) {
  PatchScene builder;
  builder.room(1, 3, {0.5f, 4.0f});
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, (4 + 0.5 * 3) / kPi, 1e-5);
}

TEST(Integrator, RelightsByGroup) {
  PatchScene builder;
  builder.room(1, 3, {0.5f, 4.0f});
  Solved solved(builder);
  solved.job.lights["light"] = {2.0, Color(1.0f, 0.5f, 0.0f)};
  const Color pixel = solved.render().pixels[0];
  EXPECT_NEAR(pixel.x, 2 * 5.5 / kPi, 1e-5);
  EXPECT_NEAR(pixel.y, 5.5 / kPi, 1e-5);
  EXPECT_EQ(pixel.z, 0);
}

TEST(Integrator, RefusesAnUnknownLightGroup) {
  PatchScene builder;
  builder.room(1, 1, {});
  Solved solved(builder);
  solved.job.lights["lamp"].scale = 2;
  EXPECT_ERROR(solved.render(), ExitCode::bad_config, "unknown light group `lamp`");
}

TEST(Integrator, ShowsBackFacesBlackOrCullsThem) {
  PatchScene builder;
  builder.quad({{{-9, -9, -1}, {-9, 9, -1}, {9, 9, -1}, {9, -9, -1}}}, 1, 1, {});      // turned away
  builder.quad({{{-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.5f});  // behind it
  Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_EQ(pixel, Color(0.0f));
  solved.job.trace.cull_backfaces = true;
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 1.5 / kPi, 1e-5);
}

TEST(Integrator, LooksThroughNodesThatCamerasDoNotSee) {
  PatchScene builder;
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 7.0f});
  builder.quad({{{-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.0f, 3.0f});
  Solved solved(builder, 0.0f, 0.0f);
  solved.scene.nodes = {"seen", "unseen"};
  solved.scene.primitives[0].node = 1;
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 7 / kPi, 1e-5);
  solved.scene.unseen = {0, 1};
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 3 / kPi, 1e-5);
}

TEST(Integrator, MirrorsShowNodesThatCamerasDoNotSee) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{-9, -9, 2}, {-9, 9, 2}, {9, 9, 2}, {9, -9, 2}}}, 1, 1, {0.0f, 3.0f});            // behind the camera
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});  // the mirror
  Solved solved(builder, 0.0f, 0.0f);
  solved.scene.nodes = {"seen", "unseen"};
  solved.scene.primitives[0].node = 1;
  solved.scene.unseen = {0, 1};
  solved.camera.vertical = 1e-3;
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 0.5 * 3 / kPi, 1e-5);
}

TEST(Integrator, AddsTheLightOfIntangibleLampsToWhatIsBehindThem) {
  for (const bool turned_away : {false, true})
    for (const bool unseen : {false, true}) {
      PatchScene builder;
      const std::array<Vec3d, 4> lamp{{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}};
      builder.quad(turned_away ? std::array{lamp[1], lamp[0], lamp[3], lamp[2]} : lamp, 1, 1, {0.0f, 7.0f});
      builder.quad({{{-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.0f, 3.0f});
      Solved solved(builder, 0.0f, 0.0f);
      solved.scene.nodes = {"wall", "lamp"};
      solved.scene.primitives[0].node = 1;
      solved.scene.primitives[0].intangible = true;
      if (unseen) solved.scene.unseen = {0, 1};
      const double expected = turned_away || unseen ? 3 : 7 + 3;
      for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, expected / kPi, 1e-5);
    }
}

TEST(Integrator, MirrorsShowIntangibleLampsBeforeWhatIsBehindThem) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{-9, -9, 2}, {-9, 9, 2}, {9, 9, 2}, {9, -9, 2}}}, 1, 1, {0.0f, 3.0f});            // behind the camera
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 7.0f});            // before it
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});  // the mirror
  Solved solved(builder, 0.0f, 0.0f);
  solved.scene.primitives[1].intangible = true;
  solved.camera.vertical = 1e-3;
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 0.5 * (3 + 7) / kPi, 1e-5);
}

TEST(Integrator, FindsDirectLightAtThePixelAndInMirrors) {
  // The camera sees, in a mirror, a wall behind it that is lit by a lamp parallel to it.
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{-9, -9, 2}, {-9, 9, 2}, {9, 9, 2}, {9, -9, 2}}}, 1, 1, {0.8f, 0.0f});            // behind the camera
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});  // the mirror
  builder.quad({{{0.5, -0.1, -0.9}, {0.7, -0.1, -0.9}, {0.7, 0.1, -0.9}, {0.5, 0.1, -0.9}}}, 1, 1, {0.0f, 5.0f});
  Solved solved(builder, 7.0f, 1.0f);
  solved.job.trace.quality = "direct";
  solved.job.trace.resolution = {1, 1};
  solved.camera.vertical = 1e-3;  // looks along the mirror's normal, at the wall behind it
  const RayScene rays(solved.scene);
  const DirectLight lamp(solved.scene, rays, explicit_emitters(solved.scene).at(0));
  const double irradiance = 1 + 5 * lamp.form_factor({0, 0, 2}, {0, 0, -1});
  EXPECT_NEAR(solved.render().pixels[0].y, 0.5 * 0.8 * irradiance / kPi, 1e-4);
  solved.energy.groups[0].gathered_direct.assign(solved.scene.patches.size(), Color(0.25f));
  EXPECT_NEAR(solved.render().pixels[0].y, 0.5 * 0.8 * (irradiance + 0.25) / kPi, 1e-4);
}

/// A floor under a lamp and an occluder that casts a soft shadow, in parallel projection from above, with the camera
/// moved `shift` pixels of 5 cm to the right.
Image floor_under_occluder(int shift) {
  constexpr int kSize = 64;
  PatchScene builder;
  builder.quad({{{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}}}, 1, 1, {0.5f});
  builder.quad({{{-0.5, 3, 0.5}, {-0.5, 3, -0.5}, {0.5, 3, -0.5}, {0.5, 3, 0.5}}}, 1, 1, {0.0f, 50.0f});
  builder.quad({{{-0.7, 1, 2}, {-0.2, 1, 2}, {-0.2, 1, -2}, {-0.7, 1, -2}}}, 1, 1, {0.5f});
  Solved solved(builder, 0.0f, 1.0f);
  solved.job.trace.quality = "direct";
  solved.job.trace.samples = 16;
  solved.job.trace.resolution = {kSize, kSize};
  solved.camera.projection = Camera::Projection::orthographic;
  solved.camera.vertical = kSize * 0.05 / 2;
  solved.camera.to_world.setAxisAngle(Vec3d(1, 0, 0), -kPi / 2);
  solved.camera.to_world[3][0] = 0.05 * shift;
  solved.camera.to_world[3][1] = 0.9;  // below the occluder
  return solved.render();
}

TEST(Integrator, SurfacesLookTheSameWhenTheCameraMoves) {
  const Image before = floor_under_occluder(0), after = floor_under_occluder(1);
  double squares = 0, pixels = 0, block_squares = 0, blocks = 0;
  for (int y = 0; y < 64; y += 9)
    for (int x = 0; x < 63; x += 9) {
      double sum = 0, difference = 0;
      for (int v = y; v < std::min(64, y + 9); ++v)
        for (int u = x; u < std::min(63, x + 9); ++u) {
          const double a = before.pixels[std::size_t(v * 64 + u + 1)].y, b = after.pixels[std::size_t(v * 64 + u)].y;
          sum += a + b;
          difference += a - b;
          squares += std::pow((a - b) / ((a + b) / 2), 2);
          ++pixels;
        }
      block_squares += std::pow(difference / (sum / 2), 2);
      ++blocks;
    }
  EXPECT_LT(std::sqrt(squares / pixels), 0.02);
  EXPECT_LT(std::sqrt(block_squares / blocks), 0.003);
}

TEST(Integrator, GivesTheSameBitsForAnyNumberOfThreads) {
  PatchScene builder;
  builder.room(1, 4, {0.5f, 1.0f});
  builder.sphere({0.2, 0, -0.6}, 0.3, 4, 6, {});
  builder.get().shaders = {{"all", {"(1+sin(9*u))/2", "abs(sin(30*x*y))", "abs(nz)"}, {"1+sin(7*v)", "u", "v"}}};
  for (Primitive& p : builder.get().primitives)
    if (p.light_group >= 0) p.shader = 0;
  Solved solved(builder);
  solved.job.trace.resolution = {80, 67};
  solved.job.trace.quality = "direct";
  std::vector<Image> images;
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    images.push_back(solved.render());
  }
  EXPECT_EQ(images[1].pixels, images[0].pixels);
  EXPECT_EQ(images[2].pixels, images[0].pixels);
}

}  // namespace
}  // namespace patchlight
