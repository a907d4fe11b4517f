#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/surface/mirror.h"
#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

/// A mirror of reflectance `specular` 1 m in front of the camera, and an emitting wall 1 m behind the camera.
PatchScene mirror_scene(const Color& specular) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", specular, 0.0f});
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 3.0f});
  return builder;
}

TEST(MetalReflection, MirrorsReflectTheirSurroundings) {
  PatchScene builder = mirror_scene(Color(0.5f, 0.25f, 1.0f));
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) {
    EXPECT_NEAR(pixel.x, 0.5 * 3 / kPi, 1e-5);
    EXPECT_NEAR(pixel.y, 0.25 * 3 / kPi, 1e-5);
  }
}

TEST(MetalReflection, MirrorsReflectTheSameFromFarAway) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  builder.quad({{{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0.01, 0.01, 0}, {-0.01, 0.01, 0}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 400}, {-9, 9, 400}, {9, 9, 400}, {9, -9, 400}}}, 1, 1, {0.0f, 3.0f});
  Solved solved(builder);
  solved.camera.to_world.translate(Vec3d(0, 0, 300));
  solved.camera.vertical = 3e-5;  // the mirror fills the frame
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 3 / kPi, 1e-5);
}

TEST(MetalReflection, PathsEndBetweenFacingMirrors) {
  PatchScene builder;
  builder.get().materials[0] = {"mirror", Color(1.0f), 0.0f};
  builder.room(1, 1, {0.0f, 0.0f});
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_EQ(pixel, Color(0.0f));
}

TEST(MetalReflection, RoughMetalsReflectEmittersByTheirLobe) {
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
        exact += exitance / kPi * solid_angle * specular_lobe(roughness, {0, 0, 1}, {0, 0, -1}, Vec3f(out)).value;
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

TEST(MetalReflection, RoughMetalsReflectManyEmittersByTheirLobe) {
  constexpr float kRoughness = 0.4f;
  PatchScene builder;
  builder.get().materials.push_back({"metal", Color(1.0f), kRoughness});
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  double exact = 0;
  for (int k = 0; k < 196; ++k) {
    const double x = 0.1 * (k % 14) + 0.2, y = 0.1 * (k / 14) - 0.7, to = 0.01;
    const float exitance = k % 5 == 0 ? 900.0f : 90.0f;
    builder.quad({{{x, y, 1}, {x, y + to, 1}, {x + to, y + to, 1}, {x + to, y, 1}}}, 1, 1, {0.0f, exitance});
    const Vec3d out = Vec3d(x + to / 2, y + to / 2, 2);
    exact += double(exitance) / kPi * to * to * out.z / std::pow(out.length(), 3) *
             double(specular_lobe(kRoughness, {0, 0, 1}, {0, 0, -1}, Vec3f(out.normalized())).value);
  }
  Solved solved(builder);
  solved.job.trace.samples = 256;
  solved.camera.vertical = 1e-3;
  double mean = 0, square = 0;
  for (const Color& pixel : solved.render().pixels) {
    mean += pixel.y / exact / 64;
    square += std::pow(pixel.y / exact - 1, 2) / 64;
  }
  EXPECT_NEAR(mean, 1, 0.02);
  EXPECT_LT(std::sqrt(square), 0.1);
}

TEST(MetalReflection, RoughMetalsReflectSurroundingsByTheirDirectionalAlbedo) {
  for (const bool lamps : {true, false}) {  // walls that emit, or that reflect the same radiance
    PatchScene builder;
    builder.get().materials.push_back({"metal", Color(1.0f), 0.5f});
    builder.room(1, 2, lamps ? PatchScene::Surface{0.0f, 3.0f} : PatchScene::Surface{0.5f, 0.0f});
    builder.get().primitives[4].material = 1;  // in front of the camera
    for (Patch& patch : builder.get().patches)
      if (patch.primitive == 4) patch.emission = patch.reflectance = Color(0.0f);
    Solved solved(builder, 4.0f, 2.0f);
    solved.job.trace.samples = 64;
    solved.camera.vertical = 0.05;
    double mean = 0;
    for (const Color& pixel : solved.render().pixels) mean += pixel.y / 64;
    EXPECT_NEAR(mean * kPi, 3 * 0.9119, 0.02) << "directional albedo of GGX at normal incidence, alpha 0.25";
  }
}

TEST(MetalReflection, MirrorsOnCurvedMeshesReflectSmoothly) {
  PatchScene builder;  // two facets at an angle; the reflection is continuous across their edge
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  builder.quad({{{-1, -1, -1.1}, {0, -1, -1}, {0, 1, -1}, {-1, 1, -1.1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{0, -1, -1}, {1, -1, -1.1}, {1, 1, -1.1}, {0, 1, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  const Vec3f left(-0.0995f, 0, 0.99504f), middle(0, 0, 1), right(0.0995f, 0, 0.99504f);
  builder.get().normals = {{left, middle, middle, left}, {middle, right, right, middle}, kFlatNormals};
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

/// A floor of rough metal beside a plane mirror, or beside what the mirror shows, under a lamp or a point light.
Image beside_a_mirror(bool mirrored, bool point, float roughness) {
  PatchScene builder;
  PatchSet& scene = builder.get();
  scene.materials.push_back({"satin", Color(0.02f), roughness});  // dark: it hardly shows itself
  scene.materials.push_back({"mirror", Color(0.8f), 0.0f});
  builder.quad({{{0, 0, 1}, {2, 0, 1}, {2, 0, -1}, {0, 0, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  if (mirrored) builder.quad({{{0, 0, 20}, {0, 0, -20}, {0, 20, -20}, {0, 20, 20}}}, 1, 1, {0.0f, 0.0f, 0, 2});
  const auto add_lamp = [&](double x, float strength) {
    if (!point) {
      builder.sphere({x, 1, 0}, 0.1, 4, 8, {0.0f, 10 * strength});
      return;
    }
    Light light = test::light_at({x, 1, 0});
    light.strength *= strength;
    scene.lights.push_back(light);
  };
  add_lamp(1, 1.0f);
  if (!mirrored) add_lamp(-1, 0.8f);
  Solved solved(builder, 0.0f, 0.0f);
  solved.camera.to_world.rotate(Vec3d(-0.7, 0.9, 0));
  solved.camera.to_world[3][0] = 1.9;
  solved.camera.to_world[3][1] = 0.8;
  solved.camera.to_world[3][2] = 0.8;
  solved.camera.vertical = 0.3;
  solved.job.trace.samples = 256;
  solved.job.trace.quality = "direct";
  return solved.render();
}

TEST(RoughMetal, ShowsLampsThatAPlaneMirrorShowsIt) {
  for (const bool point : {false, true})
    for (const float roughness : {0.25f, 0.6f}) {
      const Image with = beside_a_mirror(true, point, roughness), without = beside_a_mirror(false, point, roughness);
      double sum = 0, expected = 0, largest = 0;
      for (std::size_t p = 0; p < with.pixels.size(); ++p) {
        sum += double(with.pixels[p].x);
        expected += double(without.pixels[p].x);
        largest = std::max(largest, double(with.pixels[p].x - without.pixels[p].x));
      }
      EXPECT_GT(expected, 0);
      EXPECT_NEAR(sum / expected, 1, 0.01) << point << ' ' << roughness;
      EXPECT_LT(largest, 0.1 * expected / double(with.pixels.size())) << "no bright dots";
    }
}

}  // namespace
}  // namespace patchlight
