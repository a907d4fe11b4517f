#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/alpha_mask_scene.h"
#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

/// A wall of one patch 1 m in front of the camera, from -1 to 1 in x and y, which fills the view.
PatchScene wall_scene(const Shader& shader) {
  PatchScene builder;
  builder.quad({{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, 1, 1, {0.5f, float(kPi)});
  builder.get().shaders = {shader};
  builder.get().primitives[0].shader = 0;
  return builder;
}

/// The wall's scene with a camera whose pixel x of 8 spans u from x / 8 to (x + 1) / 8.
Solved before_wall(PatchScene builder) {
  Solved solved(builder, float(kPi), 0.0f);
  solved.camera.vertical = kPi / 2;
  return solved;
}

TEST(SurfaceColors, EvaluatesShadersAtThePixelNotThePatch) {
  const Image image = before_wall(wall_scene({"wall", {"u < 0.5 ? 0.25 : 0.75", "v", "nz"}, {}})).render();
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const Color pixel = image.pixels[std::size_t(y * 8 + x)];
      EXPECT_NEAR(pixel.x, 1 + (x < 4 ? 0.25 : 0.75), 1e-5);
      EXPECT_NEAR(pixel.y, 1 + (7.5 - y) / 8, 0.05);
      EXPECT_NEAR(pixel.z, 1 + 0.99999, 1e-5);  // clamped
    }
}

TEST(SurfaceColors, ShowsTexturesAtThePixelNotThePatch) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  builder.get().primitives[0].shader = -1;
  builder.get().primitives[0].texture = 0;
  builder.get().textures = {{2, 1, {}, true, {0x00ff00, 0xff0000}}};
  builder.get().texcoords = {kIdentityTexcoords};
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) {
    EXPECT_NEAR(image.pixels[std::size_t(x)].x, 1 + (x < 4 ? 0 : 0.99999), 1e-5);
    EXPECT_NEAR(image.pixels[std::size_t(x)].y, 1 + (x < 4 ? 0.99999 : 0), 1e-5);
  }
}

TEST(SurfaceColors, ShowsSurfacesBehindHolesAtThePixel) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  builder.get().primitives[0].shader = -1;
  builder.quad({{{-3, -3, -2}, {3, -3, -2}, {3, 3, -2}, {-3, 3, -2}}}, 1, 1, {0.0f, 3 * float(kPi)});
  test::alpha_masked(builder.get(), 0, {4, 1, {}, true, {255, 0, 0, 255}}, 0.5f);
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) EXPECT_NEAR(image.pixels[std::size_t(x)].x, x < 2 || x > 5 ? 1 + 0.5 : 3, 1e-5) << x;
}

TEST(SurfaceColors, ShowsEmissionTexturesAtThePixel) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  PatchSet& scene = builder.get();
  scene.primitives[0].shader = -1;
  scene.primitives[0].emission_texture = 0;
  scene.materials[0].emission_tint = Color(2 * float(kPi));
  scene.textures = {{4, 1, {}, true, {0x00ff00, 0xff0000, 0, 0xffffff}}};
  scene.emission_texcoords = {kIdentityTexcoords};
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) {
    EXPECT_NEAR(image.pixels[std::size_t(x)].x, 0.5 + (x / 2 == 1 || x / 2 == 3 ? 2 : 0), 1e-4) << x;
    EXPECT_NEAR(image.pixels[std::size_t(x)].y, 0.5 + (x / 2 == 0 || x / 2 == 3 ? 2 : 0), 1e-4) << x;
  }
}

TEST(SurfaceColors, MetallicRoughnessTexturesVaryTheMirror) {
  PatchScene builder = wall_scene({"wall", {}, {}});
  PatchSet& scene = builder.get();
  scene.primitives[0].shader = -1;
  scene.primitives[0].metallic_roughness_texture = 0;
  scene.primitives[0].light_group = -1;
  scene.patches[0].emission = Color(0.0f);
  scene.materials[0] = {"plate", Color(0.4f), 0.25f, Color(0.0f)};
  scene.materials[0].metal = Color(0.8f);
  scene.textures = {{2, 1, {}, true, {0x0000ff, 0x000000}}};  // a mirror on the left, no metal on the right
  scene.metallic_roughness_texcoords = {kIdentityTexcoords};
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 5 * float(kPi)});  // behind the camera
  const Image image = before_wall(builder).render();
  for (int x = 0; x < 8; ++x) EXPECT_NEAR(image.pixels[std::size_t(x)].x, x < 4 ? 0.8 * 5 : 0.8, 1e-4) << x;
}

TEST(SurfaceColors, EvaluatesEmissionUnderTheLightsSetting) {
  Solved solved = before_wall(wall_scene({"wall", {}, {"x < 0 ? 0 : 2*pi", "y - y", "-1/(z+z)"}}));
  solved.job.lights["light"].scale = 3;
  const Image image = solved.render();
  for (std::size_t x = 0; x < 8; ++x) {
    EXPECT_NEAR(image.pixels[x].x, (x < 4 ? 0 : 6) + 1.5, 1e-4);
    EXPECT_NEAR(image.pixels[x].y, 1.5, 1e-4);
    EXPECT_NEAR(image.pixels[x].z, 1.5 + 3 * 0.5 / kPi, 1e-4);
  }
}

TEST(SurfaceColors, ShadersSeeTextureCoordinates) {
  PatchScene builder = wall_scene({"wall", {"u - 3 < 0.5 ? 0.25 : 0.75", "0", "0"}, {}});
  builder.get().texcoords = {{Vec2f(3, 0), Vec2f(3, 9), Vec2f(4, 9), Vec2f(4, 0)}};  // u runs up the wall
  const Image image = before_wall(builder).render();
  EXPECT_NEAR(image.pixels[0].x, 1.75, 1e-5);
  EXPECT_NEAR(image.pixels[63].x, 1.25, 1e-5);
}

TEST(SurfaceColors, ShaderValuesAreClampedInFrames) {
  const Image image = before_wall(wall_scene({"wall", {"-1", "7", "1/(u-u)"}, {}})).render();
  for (const Color& pixel : image.pixels) {
    EXPECT_NEAR(pixel.x, 1, 1e-5);
    EXPECT_NEAR(pixel.y, 1 + 0.99999, 1e-5);
    EXPECT_NEAR(pixel.z, 1, 1e-5);
  }
}

}  // namespace
}  // namespace patchlight
