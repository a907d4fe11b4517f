// Materials of KHR_materials_pbrSpecularGlossiness, converted to metallic-roughness.
#include <gtest/gtest.h>

#include "tests/expect_error.h"
#include "tests/importers/expect_color.h"
#include "tests/importers/textured_square.h"

namespace patchlight::test {
namespace {

Json material(const Json& extension) {
  return {{"name", "paint"}, {"extensions", {{"KHR_materials_pbrSpecularGlossiness", extension}}}};
}

Json factors(const std::array<double, 3>& diffuse, const std::array<double, 3>& specular, double glossiness) {
  return {{"diffuseFactor", {diffuse[0], diffuse[1], diffuse[2], 1}},
          {"specularFactor", specular},
          {"glossinessFactor", glossiness}};
}

TEST(SpecularGlossiness, LowSpecularReflectanceIsThatOfADielectric) {
  for (const double specular : {0.0, 0.04, 0.08}) {
    Importer importer;
    GltfBuilder gltf = single_mesh(grid(1), material(factors({0.5, 0.25, 0.1}, {specular, specular, specular}, 0.3)));
    gltf.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    const PatchSet scene = importer.import(gltf);
    expect_color(scene.patches.at(0).reflectance, {0.5, 0.25, 0.1});
    EXPECT_EQ(scene.materials.at(0).specular, Color(0.0f));
    EXPECT_NEAR(scene.materials.at(0).roughness, 0.7, 1e-6);
    EXPECT_THAT(importer.messages(), ::testing::HasSubstr("are converted to metallic-roughness"));
  }
}

TEST(SpecularGlossiness, BlackDiffuseColourIsThatOfAMetal) {
  Importer importer;
  GltfBuilder gltf = single_mesh(grid(1), material(factors({0, 0, 0}, {1, 0.77, 0.34}, 0.8)));
  const PatchSet scene = importer.import(gltf);
  expect_color(scene.patches.at(0).reflectance, {0, 0, 0});
  expect_color(scene.materials.at(0).specular, {1, 0.77, 0.34});
  EXPECT_NEAR(scene.materials.at(0).roughness, 0.2, 1e-6);
}

TEST(SpecularGlossiness, MixedMaterialsKeepTheirDiffusePart) {
  // The diffuse part reflects 0.3 (1 - 0.3), which metallic-roughness has as base (1 - 0.04) (1 - metallic); the
  // specular one 0.3 = 0.04 (1 - metallic) + base metallic.
  Importer importer;
  GltfBuilder gltf = single_mesh(grid(1), material(factors({0.3, 0.3, 0.3}, {0.3, 0.3, 0.3}, 0.5)));
  const PatchSet scene = importer.import(gltf);
  const double diffuse = scene.patches.at(0).reflectance.x, metal = scene.materials.at(0).specular.x;
  EXPECT_NEAR(diffuse * 0.96, 0.3 * 0.7, 1e-4);
  EXPECT_NEAR(metal + 0.04 * diffuse / (diffuse + metal), 0.3, 1e-4);
}

TEST(SpecularGlossiness, TakesPrecedenceOverMetallicRoughnessButNotOverUnlit) {
  Importer importer;
  Json both = material(factors({0.5, 0.5, 0.5}, {0, 0, 0}, 0));
  both["pbrMetallicRoughness"] = {{"baseColorFactor", {0.2, 0.2, 0.2, 1}}, {"metallicFactor", 0}};
  GltfBuilder gltf = single_mesh(grid(1), both);
  EXPECT_NEAR(importer.import(gltf).patches.at(0).reflectance.x, 0.5, 1e-6);
  gltf.json["materials"][0]["extensions"]["KHR_materials_unlit"] = Json::object();
  EXPECT_NEAR(importer.import(gltf).patches.at(0).reflectance.x, 0.2, 1e-6);
}

TEST(SpecularGlossiness, DiffuseTextureIsTheBaseColour) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 16;
  write_row(importer.folder / "diffuse.png", {{255, 0, 0, 255}, {0, 255, 0, 255}});
  write_row(importer.folder / "glossy.png", {{0, 0, 0, 51}, {56, 56, 56, 153}});  // specular 0 and 0.04
  Json extension = factors({0.5, 1, 1}, {1, 1, 1}, 0.5);
  extension["diffuseTexture"] = {
      {"index", 0}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}};
  extension["specularGlossinessTexture"] = {{"index", 1}};
  GltfBuilder gltf = textured_square(material(extension), {"diffuse.png", "glossy.png"});
  gltf.primitive(0)["attributes"]["TEXCOORD_1"] =
      gltf.accessor(std::vector<Vec2f>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}, 5126, "VEC2");
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.textures.size(), 1u);
  expect_color(patch_at(scene, 0.125).reflectance, {0, 1, 0}, 1e-4);
  expect_color(patch_at(scene, 0.875).reflectance, {0.5, 0, 0}, 1e-4);
  EXPECT_NEAR(scene.materials.at(0).roughness, 1 - 0.5 * 0.4, 1e-3);
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("specular-glossiness textures are replaced by their means"));
}

TEST(SpecularGlossiness, TexturesOfMetalsAreReplacedOrScaled) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 16;
  write_row(importer.folder / "black.png", {{0, 0, 0, 0}, {0, 0, 0, 255}});
  write_row(importer.folder / "white.png", {{255, 255, 255, 255}, {128, 128, 128, 255}});
  Json extension = factors({1, 1, 1}, {0.9, 0.8, 0.7}, 0.9);
  extension["diffuseTexture"]["index"] = 0;
  GltfBuilder gltf = textured_square(material(extension), {"black.png"});
  PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.primitives.at(0).texture, -1);
  expect_color(scene.materials.at(0).specular, {0.9, 0.8, 0.7}, 1e-5);
  gltf.json["materials"][0]["alphaMode"] = "MASK";  // whose alpha is still that of the texture
  EXPECT_EQ(importer.import(gltf).masks.size(), 1u);

  extension.update({{"specularFactor", {0.2, 0.2, 0.2}}, {"diffuseFactor", {0.8, 0.8, 0.8, 1}}});
  gltf = textured_square(material(extension), {"white.png"});
  scene = importer.import(gltf);
  EXPECT_EQ(scene.primitives.at(0).texture, 0);
  // As of the mean diffuse colour without a texture.
  Importer plain;
  const double mean = 0.8 * (1 + std::pow((128 / 255.0 + 0.055) / 1.055, 2.4)) / 2;
  GltfBuilder constant = single_mesh(grid(1), material(factors({mean, mean, mean}, {0.2, 0.2, 0.2}, 0.9)));
  EXPECT_NEAR(scene.materials.at(0).specular.x, plain.import(constant).materials.at(0).specular.x, 1e-4);
}

TEST(SpecularGlossiness, BadValuesAreRefusedByName) {
  Importer importer;
  const auto expect_refused = [&](const char* key, const Json& value, const char* text) {
    Json extension = factors({0.5, 0.5, 0.5}, {0.04, 0.04, 0.04}, 0.5);
    extension[key] = value;
    GltfBuilder gltf = single_mesh(grid(1), material(extension));
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, text);
  };
  expect_refused("diffuseFactor", {0.5, 0.5, 0.5}, "'paint'.diffuseFactor");
  expect_refused("specularFactor", {0.5, 0.5, 1.5}, "'paint'.specularFactor");
  expect_refused("glossinessFactor", -0.5, "'paint'.glossinessFactor");
  expect_refused("glossinessFactor", "high", "must be a number");
  expect_refused("diffuseTexture", {{"index", 0}}, "index 0");
  expect_refused("specularGlossinessTexture", Json::object(), "has no index");
}

}  // namespace
}  // namespace patchlight::test
