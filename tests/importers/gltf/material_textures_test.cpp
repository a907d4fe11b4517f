#include <gtest/gtest.h>

#include <cmath>

#include "tests/expect_error.h"
#include "tests/images.h"
#include "tests/importers/expect_color.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// A PNG of 2 x 1 texels.
void write_png(const std::filesystem::path& file, const std::array<unsigned char, 6>& texels) {
  Pixels row{2, 1, 3};
  for (const unsigned char value : texels) row.values.push_back(float(value) / 255);
  write_image(file, row, PixelType::byte);
}

GltfBuilder textured(const std::string& slot, const std::string& uri) {
  Json material{{"name", "tiles"},
                {"pbrMetallicRoughness", {{"metallicFactor", slot == "metallicRoughnessTexture" ? 1 : 0}}}};
  material["pbrMetallicRoughness"][slot] = {{"index", 0}};
  GltfBuilder gltf = single_mesh(grid(1), material);
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["images"] = {{{"uri", uri}}};
  return gltf;
}

TEST(MaterialTextures, TextureWithoutCoordinatesIsReplacedByItsLinearMean) {
  Importer importer;
  write_png(importer.folder / "tiles.png", {255, 0, 188, 0, 0, 188});
  GltfBuilder gltf = textured("baseColorTexture", "tiles.png");
  const PatchSet scene = importer.import(gltf);
  const double grey = std::pow((188 / 255.0 + 0.055) / 1.055, 2.4);
  EXPECT_NEAR(scene.patches[0].reflectance.x, 0.5, 1e-4);
  EXPECT_NEAR(scene.patches[0].reflectance.y, 0.0, 1e-6);
  EXPECT_NEAR(scene.patches[0].reflectance.z, grey, 1e-4);
  ASSERT_EQ(scene.sources.size(), 2u);
  EXPECT_EQ(scene.sources[1].path, "tiles.png");
  EXPECT_EQ(scene.primitives[0].texture, -1);
}

/// The textured square with texture coordinates from 0 to 1.
GltfBuilder mapped(const std::string& uri) {
  GltfBuilder gltf = textured("baseColorTexture", uri);
  gltf.primitive(0)["attributes"]["TEXCOORD_0"] =
      gltf.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 1, 1}, 5126, "VEC2");
  gltf.json["accessors"].back()["count"] = 4;
  gltf.json["samplers"] = {{{"magFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33648}}};
  gltf.json["textures"][0]["sampler"] = 0;
  return gltf;
}

TEST(MaterialTextures, PatchesAverageTheirPartOfTheTexture) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 16;
  write_png(importer.folder / "tiles.png", {255, 0, 188, 0, 0, 188});
  GltfBuilder gltf = mapped("tiles.png");
  gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1, 1, 1};
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].texels, (std::vector<std::int32_t>{0xff00bc, 0x0000bc}));
  EXPECT_EQ(scene.textures[0].wrap, (std::array{Texture::Wrap::clamp, Texture::Wrap::mirror}));
  EXPECT_TRUE(scene.textures[0].nearest);
  EXPECT_EQ(scene.primitives[0].texture, 0);
  for (const Patch& patch : scene.patches) EXPECT_NEAR(patch.reflectance.x, patch.center.x < 0.5 ? 0.5 : 0.0, 1e-5);
}

TEST(MaterialTextures, NormalTexturesAreKeptForFrames) {
  Importer importer;
  write_png(importer.folder / "tiles.png", {128, 128, 255, 200, 128, 230});
  GltfBuilder gltf = mapped("tiles.png");
  gltf.json["materials"][0]["normalTexture"] = {{"index", 0}, {"scale", 0.75}};
  const PatchSet scene = importer.import(gltf);
  ASSERT_GE(scene.primitives[0].normal_texture, 0);
  EXPECT_FLOAT_EQ(scene.materials[0].normal_scale, 0.75f);
  EXPECT_EQ(scene.textures.at(scene.primitives[0].normal_texture).texels[0], 0x8080ff);
  gltf.json["materials"][0]["normalTexture"]["index"] = 7;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "index 7");
}

TEST(MaterialTextures, TextureUsesItsCoordinateSetAndTransform) {
  Importer importer;
  write_png(importer.folder / "tiles.png", {255, 0, 188, 0, 0, 188});
  GltfBuilder gltf = mapped("tiles.png");
  gltf.primitive(0)["attributes"]["TEXCOORD_3"] =
      gltf.accessor(std::vector<Vec2f>{{2, 0}, {3, 0}, {2, 1}, {3, 1}}, 5126, "VEC2");
  Json& info = gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  info["extensions"]["KHR_texture_transform"] = {
      {"texCoord", 3}, {"offset", {0.5, 10}}, {"scale", {2, 4}}, {"rotation", kPi / 2}};
  gltf.json["extensionsRequired"] = {"KHR_texture_transform"};
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.texcoords.size(), 1u);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d& corner = scene.primitives[0].corners[i];
    // Scaled to (4 + 2x, 4y), rotated counter-clockwise (v points down) to (4y, -4 - 2x), then offset.
    EXPECT_NEAR(scene.texcoords[0][i].x, 4 * corner.y + 0.5, 1e-5);
    EXPECT_NEAR(scene.texcoords[0][i].y, -4 - 2 * corner.x + 10, 1e-5);
  }
  info["extensions"]["KHR_texture_transform"]["offset"] = {1};
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "offset");
}

TEST(MaterialTextures, VertexColoursTintThePatches) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 16;
  GltfBuilder gltf = single_mesh(
      grid(1), {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0.5, 0.5, 0.5, 1}}}}});
  gltf.primitive(0)["attributes"]["COLOR_0"] = gltf.accessor(
      std::vector<std::uint8_t>{0, 51, 102, 255, 255, 51, 102, 0, 0, 51, 204, 255, 255, 51, 204, 0}, 5121, "VEC4");
  gltf.json["accessors"].back().update({{"count", 4}, {"normalized", true}});
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 1u);
  for (const Patch& patch : scene.patches)
    expect_color(patch.reflectance, Vec3d(patch.center.x, 0.2, 0.4 + 0.4 * patch.center.y) * 0.5);

  importer.job.materials = {MaterialOverride{"*"}};
  importer.job.materials[0].reflectance = Color(0.25f);
  EXPECT_EQ(importer.import(gltf).patches[0].reflectance, Color(0.25f));
  gltf.json["accessors"].back()["normalized"] = false;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "COLOR_0 must be VEC3 or VEC4");
}

TEST(MaterialTextures, TrianglesOfDifferentColoursAreNotMerged) {
  Importer importer;
  Mesh square = grid(1);
  square.positions = {square.positions[0], square.positions[1], square.positions[3],
                      square.positions[0], square.positions[3], square.positions[2]};
  square.indices.clear();
  GltfBuilder gltf =
      single_mesh(square, {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0.5, 0.5, 0.5, 1}}}}});
  const Vec3f red(0.5f, 0, 0), blue(0, 0, 0.5f);
  gltf.primitive(0)["attributes"]["COLOR_0"] =
      gltf.accessor(std::vector{red, red, red, blue, blue, blue}, 5126, "VEC3");
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 2u);
  for (const Patch& patch : scene.patches)
    expect_color(patch.reflectance, Vec3d(patch.primitive == 0 ? red : blue) * 0.5);
}

TEST(MaterialTextures, OverriddenReflectanceHasNoTexture) {
  Importer importer;
  importer.job.materials = {MaterialOverride{"tiles"}};
  importer.job.materials[0].reflectance = Color(0.25f);
  write_png(importer.folder / "tiles.png", {255, 0, 188, 0, 0, 188});
  GltfBuilder gltf = mapped("tiles.png");
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.primitives[0].texture, -1);
  for (const Patch& patch : scene.patches) EXPECT_EQ(patch.reflectance, Color(0.25f));
}

TEST(MaterialTextures, TexturedSpheresStayMeshes) {
  Importer importer;
  write_png(importer.folder / "tiles.png", {255, 0, 188, 0, 0, 188});
  const Mesh sphere = uv_sphere(32, 16);
  for (const bool mapped : {false, true}) {
    GltfBuilder gltf = textured("baseColorTexture", "tiles.png");
    gltf.json["nodes"][0]["mesh"] = gltf.mesh(sphere, 0);
    if (mapped)
      gltf.primitive(1)["attributes"]["TEXCOORD_0"] =
          gltf.accessor(std::vector<Vec2f>(sphere.positions.size(), Vec2f(0.25f)), 5126, "VEC2");
    const PatchSet scene = importer.import(gltf);
    EXPECT_EQ(scene.primitives[0].shape, mapped ? Primitive::Shape::quad : Primitive::Shape::sphere);
    EXPECT_EQ(scene.primitives[0].texture, mapped ? 0 : -1);
  }
}

TEST(MaterialTextures, BrokenSamplersAreRefused) {
  Importer importer;
  write_png(importer.folder / "tiles.png", {255, 0, 188, 0, 0, 188});
  GltfBuilder gltf = mapped("tiles.png");
  gltf.json["textures"][0]["sampler"] = 1;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "sampler");
}

TEST(MaterialTextures, MetallicRoughnessTextureIsLinear) {
  Importer importer;
  write_png(importer.folder / "metallic_roughness.png", {0, 51, 102, 0, 51, 102});
  GltfBuilder gltf = textured("metallicRoughnessTexture", "metallic_roughness.png");
  const PatchSet scene = importer.import(gltf);
  expect_color(scene.materials[0].specular, {0.4, 0.4, 0.4});
  EXPECT_NEAR(scene.materials[0].roughness, 0.2, 1e-5);
}

TEST(MaterialTextures, MissingTextureIsMissingInput) {
  Importer importer;
  GltfBuilder gltf = textured("baseColorTexture", "absent.png");
  EXPECT_ERROR(importer.import(gltf), ExitCode::missing_input, "absent.png");
}

TEST(MaterialTextures, OtherAndDamagedImagesAreRefused) {
  Importer importer;
  importer.folder.write("image.exr", "\x76\x2f\x31\x01 an OpenEXR file");
  importer.folder.write("image.jpg", "\xff\xd8\xff and then nothing");
  for (const char* file : {"image.exr", "image.jpg"}) {
    GltfBuilder gltf = textured("baseColorTexture", file);
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "images[0]");
  }
}

TEST(MaterialTextures, TexturesOfUnusedMaterialsAreNotRead) {
  Importer importer;
  GltfBuilder gltf = textured("baseColorTexture", "absent.png");
  gltf.primitive(0).erase("material");
  EXPECT_EQ(importer.import(gltf).primitives.size(), 1u);
}

}  // namespace
}  // namespace patchlight::test
