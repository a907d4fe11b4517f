// WebP images, KTX2 images with and without another one, and damaged files.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/expect_error.h"
#include "tests/images.h"
#include "tests/importers/expect_color.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// A lossless WebP of 16 x 16 texels of the colour (200, 100, 50). Alpha is 128 in the upper half, 0 in the lower one.
std::string lossless_webp() {
  constexpr std::array<unsigned char, 46> bytes{0x52, 0x49, 0x46, 0x46, 0x26, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50,
                                                0x56, 0x50, 0x38, 0x4c, 0x1a, 0x00, 0x00, 0x00, 0x2f, 0x0f, 0xc0, 0x03,
                                                0x10, 0x0f, 0x30, 0x64, 0x83, 0x3c, 0x32, 0x03, 0x18, 0x87, 0x10, 0x0b,
                                                0x26, 0xf9, 0x4b, 0x77, 0x4e, 0x21, 0xa2, 0xff, 0x39, 0x23};
  return {bytes.begin(), bytes.end()};
}

double linear(double byte) {
  return std::pow((byte / 255 + 0.055) / 1.055, 2.4);
}

/// An image of one colour, with 3 or 4 channels.
std::string encoded(const Importer& importer, const char* name, const std::vector<double>& texel, int side = 16) {
  Pixels pixels{side, side, int(texel.size())};
  for (int i = 0; i < side * side; ++i)
    for (const double value : texel) pixels.values.push_back(float(value / 255));
  write_image(importer.folder / name, pixels, PixelType::byte);
  return read_text(importer.folder / name);
}

/// A square with this entry of `textures` as its base colour, and images[i] of the file names[i].
GltfBuilder square(const Json& texture, const std::vector<std::string>& names) {
  GltfBuilder gltf = single_mesh(
      grid(1),
      {{"name", "tiles"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}}});
  gltf.primitive(0)["attributes"]["TEXCOORD_0"] =
      gltf.accessor(std::vector<Vec2f>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}, 5126, "VEC2");
  gltf.json["textures"] = {texture};
  for (const std::string& name : names) gltf.json["images"].push_back({{"uri", name}});
  return gltf;
}

Json with_extension(Json texture, const char* name, int source) {
  texture["extensions"][name]["source"] = source;
  return texture;
}

TEST(TextureFormats, WebpIsPreferredToThePlainImage) {
  Importer importer;
  encoded(importer, "plain.png", {0, 0, 0});
  encoded(importer, "better.webp", {128, 128, 128});
  for (const bool fallback : {false, true}) {
    GltfBuilder gltf = square(with_extension(fallback ? Json{{"source", 0}} : Json::object(), "EXT_texture_webp", 1),
                              {"plain.png", "better.webp"});
    gltf.json[fallback ? "extensionsUsed" : "extensionsRequired"] = {"EXT_texture_webp"};
    const PatchSet scene = importer.import(gltf);
    EXPECT_NEAR(scene.patches[0].reflectance.x, linear(128), 0.005) << fallback;
    EXPECT_THAT(importer.messages(), ::testing::Not(::testing::HasSubstr("warning")));
  }
  GltfBuilder gltf = square(with_extension({{"source", 0}}, "EXT_texture_webp", 2), {"plain.png", "better.webp"});
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "index 2");
}

TEST(TextureFormats, WebpColoursAreThoseBesideItsAlpha) {
  Importer importer;
  encoded(importer, "lossy.webp", {64, 64, 64, 128});  // is divided by alpha when it is written
  importer.folder.write("lossless.webp", lossless_webp());
  for (const char* mode : {"OPAQUE", "MASK"}) {
    GltfBuilder gltf = square({{"source", 0}}, {"lossless.webp"});
    gltf.json["materials"][0].update({{"alphaMode", mode}, {"alphaCutoff", 0.4}});
    const PatchSet scene = importer.import(gltf);
    expect_color(scene.patches.at(0).reflectance, {linear(200), linear(100), linear(50)}, 1e-3);
    ASSERT_EQ(scene.masks.size(), mode == std::string("MASK") ? 1u : 0u);
    if (scene.masks.empty()) continue;
    EXPECT_EQ(scene.masks[0].texels.at(0), 128);
    EXPECT_EQ(scene.masks[0].texels.at(255), 0);
  }
  GltfBuilder gltf = square({{"source", 0}}, {"lossy.webp"});
  EXPECT_NEAR(importer.import(gltf).patches.at(0).reflectance.x, linear(64) * 255 / 128, 0.01);
}

TEST(TextureFormats, WebpWithoutAlphaIsOpaque) {
  Importer importer;
  encoded(importer, "plain.webp", {128, 128, 128});
  GltfBuilder gltf = square({{"source", 0}}, {"plain.webp"});
  gltf.json["materials"][0]["alphaMode"] = "MASK";
  const PatchSet scene = importer.import(gltf);
  EXPECT_TRUE(scene.masks.empty());
  EXPECT_NEAR(scene.patches.at(0).reflectance.x, linear(128), 0.01);
}

TEST(TextureFormats, KtxIsReplacedByThePlainImageOrRefused) {
  Importer importer;
  encoded(importer, "plain.png", {128, 128, 128});
  importer.folder.write("better.ktx2", "\xabKTX 20\xbb");
  GltfBuilder gltf = square(with_extension({{"source", 0}}, "KHR_texture_basisu", 1), {"plain.png", "better.ktx2"});
  gltf.json["extensionsUsed"] = {"KHR_texture_basisu"};
  EXPECT_NEAR(importer.import(gltf).patches[0].reflectance.x, linear(128), 0.005);
  EXPECT_THAT(importer.messages(), ::testing::Not(::testing::HasSubstr("warning")));

  gltf.json["textures"][0].erase("source");
  gltf.json["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "compressed by KHR_texture_basisu");
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "textures[0]");
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "gltf-transform ktxdecompress");
  gltf.json["materials"][0]["alphaMode"] = "MASK";
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "compressed by KHR_texture_basisu");
  gltf.primitive(0).erase("material");
  EXPECT_EQ(importer.import(gltf).primitives.size(), 1u);
}

/// Expects that a texture of these bytes is refused.
void expect_refused(Importer& importer, const std::string& bytes, ExitCode code, const char* text) {
  importer.folder.write("image", bytes);
  GltfBuilder gltf = square({{"source", 0}}, {"image"});
  EXPECT_ERROR(importer.import(gltf), code, text);
}

TEST(TextureFormats, BadWebpIsRefused) {
  Importer importer;
  const std::string alpha = encoded(importer, "alpha.webp", {64, 64, 64, 128}), lossless = lossless_webp();
  for (const std::string& intact : {encoded(importer, "plain.webp", {128, 128, 128}, 64), alpha, lossless})
    for (const std::size_t left : {std::size_t{16}, std::size_t{25}, intact.size() / 2, intact.size() - 3})
      expect_refused(importer, intact.substr(0, left), ExitCode::bad_data, "images[0]");

  std::string changed = alpha;
  changed.at(20) = char(changed.at(20) | 2);
  expect_refused(importer, changed, ExitCode::bad_data, "animated");
  changed = alpha;
  changed.at(26) = changed.at(29) = '\x7f';
  expect_refused(importer, changed, ExitCode::over_limit, "is too large");
  changed = lossless;
  for (std::size_t i = 21; i < 25; ++i) changed.at(i) = '\x1f';
  expect_refused(importer, changed, ExitCode::over_limit, "7968 x 15485");
}

TEST(TextureFormats, TruncatedImagesAreRefused) {
  Importer importer;
  Pixels noise{64, 64, 3};
  std::uint32_t random = 1;
  for (int i = 0; i < 64 * 64 * 3; ++i)
    noise.values.push_back(float((random = random * 1664525u + 1013904223u) >> 24) / 255);
  for (const char* name : {"noise.jpg", "noise.png", "noise.webp"}) {
    write_image(importer.folder / name, noise, PixelType::byte);
    const std::string intact = read_text(importer.folder / name);
    for (const double left : {0.05, 0.3, 0.6, 0.95})
      expect_refused(importer, intact.substr(0, std::size_t(double(intact.size()) * left)), ExitCode::bad_data,
                     "images[0]");
    importer.folder.write("image", intact);
    GltfBuilder gltf = square({{"source", 0}}, {"image"});
    EXPECT_NO_THROW(importer.import(gltf)) << name;
  }
}

TEST(TextureFormats, JpegWithBytesToSpareIsRead) {
  Importer importer;
  std::string bytes = encoded(importer, "plain.jpg", {128, 128, 128});
  const std::string end = bytes.substr(bytes.size() - 2);
  importer.folder.write("image", bytes.substr(0, bytes.size() - 2) + "spare" + end + "more");
  GltfBuilder gltf = square({{"source", 0}}, {"image"});
  EXPECT_NEAR(importer.import(gltf).patches.at(0).reflectance.x, linear(128), 0.01);
}

}  // namespace
}  // namespace patchlight::test
