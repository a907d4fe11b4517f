#include "pipeline/optics/surface/texture_lookup.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

float linear(double encoded) {
  const double x = encoded / 255;
  return float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

/// Two texels: red 0 and 200, green 40 in both, blue 255 and 0.
Texture two_texels() {
  return {2, 1, {Texture::Wrap::repeat, Texture::Wrap::repeat}, false, {0x0028ff, 0xc82800}};
}

TEST(TextureLookup, ReturnsTexelsAtTheirCenters) {
  const Color left = texture_color(two_texels(), {0.25, 0.5}), right = texture_color(two_texels(), {0.75, 0.5});
  EXPECT_NEAR(left.x, 0, 1e-5);
  EXPECT_NEAR(left.y, linear(40), 1e-5);
  EXPECT_NEAR(left.z, 1, 1e-5);
  EXPECT_NEAR(right.x, linear(200), 1e-5);
  EXPECT_NEAR(right.z, 0, 1e-5);
}

TEST(TextureLookup, InterpolatesInSrgbEncoding) {
  EXPECT_NEAR(texture_color(two_texels(), {0.5, 0.5}).x, linear(100), 1e-5);
  EXPECT_NEAR(texture_color(two_texels(), {0.375, 0.5}).x, linear(50), 1e-5);
  Texture nearest = two_texels();
  nearest.nearest = true;
  EXPECT_NEAR(texture_color(nearest, {0.49, 0.5}).x, 0, 1e-5);
  EXPECT_NEAR(texture_color(nearest, {0.51, 0.5}).x, linear(200), 1e-5);
}

TEST(TextureLookup, FollowsTheWrapMode) {
  Texture texture = two_texels();
  EXPECT_NEAR(texture_color(texture, {-0.25, 7.3}).x, linear(200), 1e-5);
  EXPECT_NEAR(texture_color(texture, {0.0, 0.5}).x, linear(100), 1e-5);
  texture.wrap[0] = Texture::Wrap::clamp;
  EXPECT_NEAR(texture_color(texture, {-0.25, 0.5}).x, 0, 1e-5);
  EXPECT_NEAR(texture_color(texture, {9.0, 0.5}).x, linear(200), 1e-5);
  texture.wrap[0] = Texture::Wrap::mirror;
  EXPECT_NEAR(texture_color(texture, {1.25, 0.5}).x, linear(200), 1e-5);
  EXPECT_NEAR(texture_color(texture, {-0.25, 0.5}).x, 0, 1e-5);
  for (const double far : {1e30, -1e30}) EXPECT_TRUE(std::isfinite(texture_color(texture, {far, far}).x));
}

TEST(TextureLookup, FirstRowIsTheTop) {
  const Texture column{1, 2, {Texture::Wrap::clamp, Texture::Wrap::clamp}, false, {0xffffff, 0}};
  EXPECT_NEAR(texture_color(column, {0.5, 0.1}).y, 1, 1e-5);
  EXPECT_NEAR(texture_color(column, {0.5, 0.9}).y, 0, 1e-5);
}

TEST(TextureLookup, ReflectanceIsTintedAndLimitedByTheSpecularPart) {
  test::PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  PatchSet& scene = builder.get();
  scene.textures = {{1, 1, {}, false, {0xffffff}}};
  scene.primitives[0].texture = 0;
  scene.texcoords = {kIdentityTexcoords};
  scene.materials[0].tint = Color(0.5f, 0.25f, 1.0f);
  scene.materials[0].specular = Color(0.4f);
  const Color color = colored_reflectance(scene, 0, 0.3, 0.3);
  EXPECT_NEAR(color.x, 0.5, 1e-5);
  EXPECT_NEAR(color.y, 0.25, 1e-5);
  EXPECT_NEAR(color.z, 0.6, 1e-5);
}

}  // namespace
}  // namespace patchlight
