#include "tracer/integrator.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/mirror.h"
#include "tests/cutout_scene.h"
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

/// A mirror 1 m before the camera, of reflectance `specular`, and a glowing wall 1 m behind it.
PatchScene mirror_scene(const Color& specular) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", specular, 0.0f});
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 3.0f});
  return builder;
}

TEST(Integrator, MirrorsShowWhatIsBeforeThem) {
  PatchScene builder = mirror_scene(Color(0.5f, 0.25f, 1.0f));
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) {
    EXPECT_NEAR(pixel.x, 0.5 * 3 / kPi, 1e-5);
    EXPECT_NEAR(pixel.y, 0.25 * 3 / kPi, 1e-5);
  }
}

TEST(Integrator, MirrorsShowAsMuchFromFarAway) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  builder.quad({{{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0.01, 0.01, 0}, {-0.01, 0.01, 0}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 400}, {-9, 9, 400}, {9, 9, 400}, {9, -9, 400}}}, 1, 1, {0.0f, 3.0f});
  Solved solved(builder);
  solved.camera.to_world.translate(Vec3d(0, 0, 300));
  solved.camera.vertical = 3e-5;  // the mirror fills the frame
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 3 / kPi, 1e-5);
}

TEST(Integrator, EndsBetweenMirrorsThatFaceEachOther) {
  PatchScene builder;
  builder.get().materials[0] = {"mirror", Color(1.0f), 0.0f};
  builder.room(1, 1, {0.0f, 0.0f});
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_EQ(pixel, Color(0.0f));
}

TEST(Integrator, SeesBacksBlackOrLooksThroughThem) {
  PatchScene builder;
  builder.quad({{{-9, -9, -1}, {-9, 9, -1}, {9, 9, -1}, {9, -9, -1}}}, 1, 1, {});      // turned away
  builder.quad({{{-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.5f});  // behind it
  Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_EQ(pixel, Color(0.0f));
  solved.job.trace.cull_backfaces = true;
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 1.5 / kPi, 1e-5);
}

TEST(Integrator, FindsDirectLightAtThePixelAndInMirrors) {
  // The camera looks at a wall, 2 m behind which, across a mirror, stands a lamp that is parallel to it.
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{-9, -9, 2}, {-9, 9, 2}, {9, 9, 2}, {9, -9, 2}}}, 1, 1, {0.8f, 0.0f});            // behind the camera
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});  // the mirror
  builder.quad({{{0.5, -0.1, -0.9}, {0.7, -0.1, -0.9}, {0.7, 0.1, -0.9}, {0.5, 0.1, -0.9}}}, 1, 1, {0.0f, 5.0f});
  Solved solved(builder, 7.0f, 1.0f);
  solved.job.trace.quality = "direct";
  solved.job.trace.resolution = {1, 1};
  solved.camera.vertical = 1e-3;  // it sees itself in the mirror, and the wall behind
  const RayScene rays(solved.scene);
  const DirectLight lamp(solved.scene, rays, emitters_apart(solved.scene).at(0));
  const double irradiance = 1 + 5 * lamp.form_factor({0, 0, 2}, {0, 0, -1});
  EXPECT_NEAR(solved.render().pixels[0].y, 0.5 * 0.8 * irradiance / kPi, 1e-4);
  solved.energy.groups[0].direct_by_rows.assign(solved.scene.patches.size(), Color(0.25f));
  EXPECT_NEAR(solved.render().pixels[0].y, 0.5 * 0.8 * (irradiance + 0.25) / kPi, 1e-4);
}

TEST(Integrator, RoughMetalsShowEmittersAsTheirLobesHaveThem) {
  for (const float roughness : {0.1f, 0.3f, 0.7f}) {
    PatchScene builder;
    builder.get().materials.push_back({"metal", Color(1.0f, 0.5f, 0.25f), roughness});
    builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
    builder.quad({{{0.1, 0, 1}, {0.1, 0.4, 1}, {0.5, 0.4, 1}, {0.5, 0, 1}}}, 1, 1, {0.0f, 5.0f});
    builder.quad({{{-2, 0, 3}, {-2, 1, 3}, {-1, 1, 3}, {-1, 0, 3}}}, 1, 1, {0.0f, 20.0f});
    Solved solved(builder);
    solved.job.trace.samples = 256;
    solved.camera.vertical = 1e-3;
    double exact = 0;
    const auto add_lamp = [&](double x0, double y0, double z, double size, double exitance) {
      constexpr int kFine = 200;
      for (int k = 0; k < kFine * kFine; ++k) {
        const Vec3d to(x0 + (k % kFine + 0.5) / kFine * size, y0 + (k / kFine + 0.5) / kFine * size, z + 1);
        const Vec3d out = to.normalized();
        const double solid_angle = size * size / (kFine * kFine) * out.z / to.length2();
        exact += exitance / kPi * solid_angle * metal_lobe(roughness, {0, 0, 1}, {0, 0, -1}, Vec3f(out)).value;
      }
    };
    add_lamp(0.1, 0, 1, 0.4, 5);
    add_lamp(-2, 0, 3, 1, 20);
    Color mean(0.0f);
    for (const Color& pixel : solved.render().pixels) mean += pixel / 64;
    EXPECT_NEAR(mean.x, exact, 0.02 * exact) << roughness;
    EXPECT_NEAR(mean.z, 0.25 * exact, 0.02 * 0.25 * exact) << roughness;
  }
}

TEST(Integrator, RoughMetalsShowSurroundingsLessWhatTheirFacetsKeep) {
  for (const bool lamps : {true, false}) {  // that glow, or that reflect as much
    PatchScene builder;
    builder.get().materials.push_back({"metal", Color(1.0f), 0.5f});
    builder.room(1, 2, lamps ? PatchScene::Surface{0.0f, 3.0f} : PatchScene::Surface{0.5f, 0.0f});
    builder.get().primitives[4].material = 1;  // before the camera
    for (Patch& patch : builder.get().patches)
      if (patch.primitive == 4) patch.emission = patch.reflectance = Color(0.0f);
    Solved solved(builder, 4.0f, 2.0f);
    solved.job.trace.samples = 64;
    solved.camera.vertical = 0.05;
    double mean = 0;
    for (const Color& pixel : solved.render().pixels) mean += pixel.y / 64;
    EXPECT_NEAR(mean * kPi, 3 * 0.9119, 0.02) << "as Mirror.RoughOnesReflectWhatTheirMicrofacetsLeave has it";
  }
}

TEST(Integrator, MirrorsOnCurvedMeshesTurnSmoothly) {
  PatchScene builder;  // two facets at an angle; what they show runs on from one to the other
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  builder.quad({{{-1, -1, -1.1}, {0, -1, -1}, {0, 1, -1}, {-1, 1, -1.1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{0, -1, -1}, {1, -1, -1.1}, {1, 1, -1.1}, {0, 1, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.get().primitives[0].smooth_vertices = {0, 1, 2, 3};
  builder.get().primitives[1].smooth_vertices = {1, 4, 5, 2};
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 1.0f});
  builder.get().shaders = {{"ramp", {}, {"2 + x", "1", "1"}}};
  builder.get().primitives[2].shader = 0;
  Solved solved(builder);
  solved.job.trace.resolution = {64, 1};
  solved.camera.vertical = 0.02;
  const Image image = solved.render();
  for (std::size_t x = 1; x < 64; ++x)
    EXPECT_NEAR(image.pixels[x].x, image.pixels[x - 1].x, 0.05) << "no step at the edge";
  EXPECT_GT(image.pixels[63].x - image.pixels[0].x, 0.1);
}

TEST(Integrator, EdgesAreTheShareOfThePixelThatIsCovered) {
  PatchScene builder;  // an emitter over the left 0.3 of the one pixel's width
  builder.quad({{{-1, -1, -1}, {-0.4, -1, -1}, {-0.4, 1, -1}, {-1, 1, -1}}}, 1, 1, {0.0f, float(kPi)});
  Solved solved(builder);
  solved.job.trace.resolution = {1, 1};
  solved.job.trace.samples = 256;
  solved.camera.vertical = kPi / 2;
  EXPECT_NEAR(solved.render().pixels[0].y, 0.3, 0.01);
}

/// An emitter of radiance 1 that covers what is left of a slanted edge, seen by a camera to whose image plane, at
/// distance 1, both are parallel: from `low` at the lower edge of the view to `high` at the upper one.
Solved slanted_edge(double low, double high, int size, int samples) {
  PatchScene builder;
  builder.quad({{{-3, -1, -1}, {low, -1, -1}, {high, 1, -1}, {-3, 1, -1}}}, 1, 1, {0.0f, float(kPi)});
  Solved solved(builder);
  solved.job.trace.resolution = {size, size};
  solved.job.trace.samples = samples;
  solved.camera.vertical = kPi / 2;
  return solved;
}

/// The part of a pixel that lies left of such an edge.
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

TEST(Integrator, EdgesAreAsGoodAsFourTimesTheSamplesAreUnderGoodStratification) {
  constexpr int kSize = 40;
  for (const int samples : {4, 16, 64}) {
    const Image image = slanted_edge(-0.31, 0.42, kSize, samples).render();
    double squares = 0;
    int crossed = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double exact = covered(-0.31, 0.42, kSize, x, y), is = image.pixels[std::size_t(y * kSize + x)].y;
        if (exact <= 0 || exact >= 1) {
          EXPECT_NEAR(is, exact, 1e-5);
          continue;
        }
        squares += (is - exact) * (is - exact);
        ++crossed;
      }
    // Of n x n stratified samples an edge crosses about n, each of which is wrong by chance.
    const double sides = 2 * std::sqrt(double(samples));
    EXPECT_GT(crossed, 40);
    EXPECT_LT(std::sqrt(squares / crossed), 0.5 * std::pow(sides, -1.5)) << samples;
  }
}

TEST(Integrator, OneSampleIsOneSampleEverywhere) {
  const Image image = slanted_edge(-0.31, 0.42, 40, 1).render();
  for (const Color& pixel : image.pixels) EXPECT_LT(std::min(std::abs(pixel.y), std::abs(pixel.y - 1)), 1e-5);
}

/// What comes of a bright sliver, of the width of a hundredth of a pixel and as long as the image is high, in parts of
/// what should. `shift`: in pixels.
double sliver_seen(bool mirrored, double shift) {
  constexpr int kSize = 24;
  const double width = 2.0 / kSize / 100, low = -0.3 + shift * 2.0 / kSize, high = low + 0.5;
  PatchScene builder;
  const double z = mirrored ? 0 : -1;
  std::array<Vec3d, 4> corners{{{low, -1, z}, {low + width, -1, z}, {high + width, 1, z}, {high, 1, z}}};
  if (mirrored) {
    std::reverse(corners.begin(), corners.end());  // behind the camera's back, towards the mirror before it
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

TEST(Integrator, AThinBrightSliverIsNotLostInTheMean) {
  for (const bool mirrored : {false, true}) {
    constexpr int kFrames = 400;
    double mean = 0;
    for (int k = 0; k < kFrames; ++k) mean += sliver_seen(mirrored, 3.7 * k / kFrames) / kFrames;
    EXPECT_NEAR(mean, 1, mirrored ? 0.15 : 0.04) << mirrored;  // about 3 standard deviations
  }
}

TEST(Integrator, AnEvenImageIsExactAtFewSamples) {
  PatchScene builder;
  builder.quad({{{-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.8f, 0.0f});
  builder.quad({{{-1, -1, 3}, {-1, 1, 3}, {1, 1, 3}, {1, -1, 3}}}, 1, 1, {0.0f, 5.0f});
  Solved solved(builder, 7.0f, 1.0f);
  solved.job.trace.quality = "direct";
  solved.job.trace.resolution = {40, 40};
  solved.camera.vertical = 1.0;
  const RayScene ray_scene(solved.scene);
  const DirectLight lamp(solved.scene, ray_scene, emitters_apart(solved.scene).at(0));
  const Image image = solved.render();
  const CameraRays rays(solved.camera, 40, 40);
  for (int k = 0; k < 40 * 40; ++k) {
    const CameraRay ray = rays(float(k % 40) + 0.5f, float(k / 40) + 0.5f);
    const Vec3d at = Vec3d(ray.direction) * (-2 / double(ray.direction.z));
    const double exact = 0.8 * (1 + 5 * lamp.form_factor(at, {0, 0, 1})) / kPi;
    EXPECT_NEAR(image.pixels[std::size_t(k)].y, exact, 2e-3 * exact);
  }
}

/// A wall of one patch that fills the view, 1 m before the camera, from -1 to 1 in x and y.
PatchScene wall_scene(const Shader& shader) {
  PatchScene builder;
  builder.quad({{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, 1, 1, {0.5f, float(kPi)});
  builder.get().shaders = {shader};
  builder.get().primitives[0].shader = 0;
  return builder;
}

/// Seen so that pixel x of 8 spans u from x / 8 to (x + 1) / 8.
Solved before_wall(PatchScene builder) {
  Solved solved(builder, float(kPi), 0.0f);
  solved.camera.vertical = kPi / 2;
  return solved;
}

TEST(Integrator, EvaluatesShadersAtThePixelNotThePatch) {
  const Image image = before_wall(wall_scene({"wall", {"u < 0.5 ? 0.25 : 0.75", "v", "nz"}, {}})).render();
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const Color pixel = image.pixels[std::size_t(y * 8 + x)];
      EXPECT_NEAR(pixel.x, 1 + (x < 4 ? 0.25 : 0.75), 1e-5);
      EXPECT_NEAR(pixel.y, 1 + (7.5 - y) / 8, 0.05);
      EXPECT_NEAR(pixel.z, 1 + 0.99999, 1e-5);  // lowered
    }
}

TEST(Integrator, ShowsTexturesAtThePixelNotThePatch) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  builder.get().primitives[0].shader = -1;
  builder.get().primitives[0].texture = 0;
  builder.get().textures = {{2, 1, {}, true, {0x00ff00, 0xff0000}}};
  builder.get().texcoords = {kOwnTexcoords};
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) {
    EXPECT_NEAR(image.pixels[std::size_t(x)].x, 1 + (x < 4 ? 0 : 0.99999), 1e-5);
    EXPECT_NEAR(image.pixels[std::size_t(x)].y, 1 + (x < 4 ? 0.99999 : 0), 1e-5);
  }
}

TEST(Integrator, ShowsWhatStandsBehindHolesAtThePixel) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  builder.get().primitives[0].shader = -1;
  builder.quad({{{-3, -3, -2}, {3, -3, -2}, {3, 3, -2}, {-3, 3, -2}}}, 1, 1, {0.0f, 3 * float(kPi)});
  test::cut_out(builder.get(), 0, {4, 1, {}, true, {255, 0, 0, 255}}, 0.5f);
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) EXPECT_NEAR(image.pixels[std::size_t(x)].x, x < 2 || x > 5 ? 1 + 0.5 : 3, 1e-5) << x;
}

TEST(Integrator, ShowsEmissionTexturesAtThePixel) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  PatchSet& scene = builder.get();
  scene.primitives[0].shader = -1;
  scene.primitives[0].emission_texture = 0;
  scene.materials[0].emission_tint = Color(2 * float(kPi));
  scene.textures = {{4, 1, {}, true, {0x00ff00, 0xff0000, 0, 0xffffff}}};
  scene.emission_texcoords = {kOwnTexcoords};
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) {
    EXPECT_NEAR(image.pixels[std::size_t(x)].x, 0.5 + (x / 2 == 1 || x / 2 == 3 ? 2 : 0), 1e-4) << x;
    EXPECT_NEAR(image.pixels[std::size_t(x)].y, 0.5 + (x / 2 == 0 || x / 2 == 3 ? 2 : 0), 1e-4) << x;
  }
}

TEST(Integrator, FinishTexturesAreMirrorsWhereTheySaySo) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  PatchSet& scene = builder.get();
  scene.primitives[0].shader = -1;
  scene.primitives[0].finish_texture = 0;
  scene.primitives[0].light_group = -1;
  scene.patches[0].emission = Color(0.0f);
  scene.materials[0] = {"plate", Color(0.4f), 0.25f, Color(0.0f)};
  scene.materials[0].metal = Color(0.8f);
  scene.textures = {{2, 1, {}, true, {0x0000ff, 0x000000}}};  // a mirror, and no metal
  scene.finish_texcoords = {kOwnTexcoords};
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 5 * float(kPi)});  // behind the camera
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) EXPECT_NEAR(image.pixels[std::size_t(x)].x, x < 4 ? 0.8 * 5 : 0.8, 1e-4) << x;
}

TEST(Integrator, EvaluatesEmissionUnderTheLightsSetting) {
  Solved solved = before_wall(wall_scene({"wall", {}, {"x < 0 ? 0 : 2*pi", "y - y", "-1/(z+z)"}}));
  solved.job.lights["light"].scale = 3;
  const Image image = solved.render();
  for (std::size_t x = 0; x < 8; ++x) {
    EXPECT_NEAR(image.pixels[x].x, (x < 4 ? 0 : 6) + 1.5, 1e-4);
    EXPECT_NEAR(image.pixels[x].y, 1.5, 1e-4);
    EXPECT_NEAR(image.pixels[x].z, 1.5 + 3 * 0.5 / kPi, 1e-4);
  }
}

TEST(Integrator, ShadersSeeTextureCoordinates) {
  PatchScene builder = wall_scene({"wall", {"u - 3 < 0.5 ? 0.25 : 0.75", "0", "0"}, {}});
  builder.get().texcoords = {{Vec2f(3, 0), Vec2f(3, 9), Vec2f(4, 9), Vec2f(4, 0)}};  // u runs up the wall
  const Image image = before_wall(builder).render();
  EXPECT_NEAR(image.pixels[0].x, 1.75, 1e-5);
  EXPECT_NEAR(image.pixels[63].x, 1.25, 1e-5);
}

TEST(Integrator, ShadersAreBroughtIntoRangeInFrames) {
  const Image image = before_wall(wall_scene({"wall", {"-1", "7", "1/(u-u)"}, {}})).render();
  for (const Color& pixel : image.pixels) {
    EXPECT_NEAR(pixel.x, 1, 1e-5);
    EXPECT_NEAR(pixel.y, 1 + 0.99999, 1e-5);
    EXPECT_NEAR(pixel.z, 1, 1e-5);
  }
}

/// A floor under a lamp and a screen whose shadow's edge is soft, seen in parallel from above, `shift` pixels of 5 cm
/// to the right.
Image floor_under_screen(int shift) {
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
  solved.camera.to_world[3][1] = 0.9;  // below the screen
  return solved.render();
}

TEST(Integrator, SurfacesLookTheSameWhileTheCameraMoves) {
  const Image before = floor_under_screen(0), after = floor_under_screen(1);
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
