// Emission and metallic-roughness textures, and vertex colours combined with textures.
#include <gtest/gtest.h>

#include "pipeline/optics/surface/specular.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "tests/expect_error.h"
#include "tests/importers/textured_square.h"

namespace patchlight::test {
namespace {

/// A property at (x, y) of the square.
template <class Property>
auto at(const Property& property, const PatchSet& scene, double x, double y, std::int32_t side = 0) {
  const Imath::V2d uv = uv_of(scene, side, x, y);
  return property(scene, side, uv.x, uv.y);
}

void expect_near(const Color& actual, const Vec3d& expected, double tolerance = 1e-4) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(actual[k], expected[k], tolerance) << k;
}

TEST(Textures, EmissionIsThatOfEachPatch) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 16;
  write_row(importer.folder / "sign.png", {{255, 0, 0, 255}, {0, 0, 0, 255}, {0, 255, 0, 255}, {255, 255, 255, 255}});
  GltfBuilder gltf = textured_square({{"name", "sign"},
                                      {"emissiveFactor", {1, 1, 0.5}},
                                      {"emissiveTexture", {{"index", 0}}},
                                      {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}},
                                      {"pbrMetallicRoughness", {{"metallicFactor", 0}}}},
                                     {"sign.png"});
  const PatchSet scene = importer.import(gltf);
  expect_near(patch_at(scene, 0.125).emission, {4 * kPi, 0, 0});
  expect_near(patch_at(scene, 0.375).emission, {0, 0, 0});
  expect_near(patch_at(scene, 0.875).emission, {4 * kPi, 4 * kPi, 2 * kPi});
  EXPECT_EQ(scene.primitives[0].emission_texture, 0);
  EXPECT_EQ(scene.primitives[0].texture, -1);
  EXPECT_EQ(scene.light_groups, std::vector<std::string>{"sign"});
  expect_near(at(textured_emission, scene, 0.6, 0.1), {0, 4 * kPi, 0});

  importer.job.materials = {{"sign"}};
  importer.job.materials[0].emission = Color(3.0f);
  const PatchSet overridden = importer.import(gltf);
  EXPECT_EQ(overridden.primitives[0].emission_texture, -1);
  EXPECT_EQ(patch_at(overridden, 0.375).emission, Color(3.0f));
}

TEST(Textures, MetallicRoughnessAndBaseColourMultiplyPerTexel) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 4;
  // Metal, not metal | half metal, metal; on a base of light and dark, so that means of products are not products of
  // means.
  write_row(importer.folder / "metallic_roughness.png",
            {{0, 51, 255, 255}, {0, 102, 0, 255}, {0, 153, 51, 255}, {0, 0, 255, 255}});
  write_row(importer.folder / "base.png",
            {{255, 255, 255, 255}, {255, 0, 0, 255}, {255, 255, 255, 255}, {0, 0, 0, 255}});
  GltfBuilder gltf = textured_square({{"name", "plate"},
                                      {"pbrMetallicRoughness",
                                       {{"metallicFactor", 1},
                                        {"roughnessFactor", 0.5},
                                        {"baseColorFactor", {0.5, 0.5, 0.5, 1}},
                                        {"baseColorTexture", {{"index", 0}}},
                                        {"metallicRoughnessTexture", {{"index", 1}}}}}},
                                     {"base.png", "metallic_roughness.png"});
  const PatchSet scene = importer.import(gltf);
  expect_near(patch_at(scene, 0.25).reflectance, {0.25, 0, 0}, 1e-3);
  expect_near(patch_at(scene, 0.75).reflectance, {0.2, 0.2, 0.2}, 1e-3);
  const std::array<SpecularProperties, 4> samples{
      at(specular_properties_at, scene, 0.1, 0.5), at(specular_properties_at, scene, 0.3, 0.5),
      at(specular_properties_at, scene, 0.6, 0.5), at(specular_properties_at, scene, 0.9, 0.5)};
  expect_near(samples[0].metal, {0.5, 0.5, 0.5});
  expect_near(samples[1].metal, {0, 0, 0});
  expect_near(samples[2].metal, {0.1, 0.1, 0.1});
  expect_near(samples[3].metal, {0, 0, 0});
  EXPECT_NEAR(samples[0].roughness, 0.1, 1e-5);
  EXPECT_NEAR(samples[2].roughness, 0.3, 1e-5);
  expect_near(at(colored_reflectance, scene, 0.6, 0.5), {0.4, 0.4, 0.4});

  importer.job.materials = {{"plate"}};
  importer.job.materials[0].mirror = Color(0.25f);
  const PatchSet mirror = importer.import(gltf);
  expect_near(at(specular_properties_at, mirror, 0.3, 0.5).metal, {0.25, 0.25, 0.25});
}

TEST(Textures, EachUsesItsOwnCoordinateSetAndTransform) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 16;
  write_row(importer.folder / "row.png", {{255, 255, 0, 255}, {0, 255, 255, 255}});
  GltfBuilder gltf = textured_square(
      {{"name", "sign"},
       {"emissiveFactor", {1, 1, 1}},
       {"emissiveTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}}},
       {"pbrMetallicRoughness",
        {{"metallicFactor", 1},
         {"baseColorTexture", {{"index", 0}}},
         {"metallicRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}}},
      {"row.png"});
  gltf.primitive(0)["attributes"]["TEXCOORD_1"] =
      gltf.accessor(std::vector<Vec2f>{{0, 0}, {0, 0}, {1, 0}, {1, 0}}, 5126, "VEC2");  // along y
  gltf.json["materials"][0]["doubleSided"] = true;
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 2u);
  for (const std::int32_t side : {0, 1}) {
    expect_near(at(textured_emission, scene, 0.25, 0.5, side), Vec3d(0, 1, 1) * kPi);
    expect_near(at(textured_emission, scene, 0.75, 0.5, side), Vec3d(1, 1, 0) * kPi);
    expect_near(at(specular_properties_at, scene, 0.25, 0.25, side).metal, {0, 0, 0});
    expect_near(at(specular_properties_at, scene, 0.25, 0.75, side).metal, {1, 1, 0});
    expect_near(at(specular_properties_at, scene, 0.75, 0.75, side).metal, {0, 1, 1});
  }
}

TEST(Textures, VertexColoursMultiplyTextures) {
  Importer importer;
  importer.job.import.patch_area = 1.0 / 16;
  write_row(importer.folder / "row.png", {{255, 255, 0, 255}, {0, 255, 255, 255}});
  GltfBuilder gltf = textured_square(
      {{"name", "cloth"},
       {"pbrMetallicRoughness",
        {{"metallicFactor", 0}, {"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"baseColorTexture", {{"index", 0}}}}}},
      {"row.png"});
  gltf.primitive(0)["attributes"]["COLOR_0"] =
      gltf.accessor(std::vector<Vec3f>{{0, 1, 1}, {1, 1, 1}, {0, 1, 1}, {1, 1, 1}}, 5126, "VEC3");
  const PatchSet scene = importer.import(gltf);
  expect_near(at(colored_reflectance, scene, 0.4, 0.2), {0.2, 0.5, 0});
  expect_near(patch_at(scene, 0.125).reflectance, {0.0625, 0.5, 0});
  expect_near(patch_at(scene, 0.875).reflectance, {0, 0.5, 0.5});
}

TEST(Textures, UnlitMaterialsAreDiffuse) {
  Importer importer;
  GltfBuilder gltf = single_mesh(grid(1), {{"name", "sky"},
                                           {"extensions", {{"KHR_materials_unlit", Json::object()}}},
                                           {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 0.125, 1}}}}});
  gltf.json["extensionsUsed"] = {"KHR_materials_unlit"};
  const PatchSet scene = importer.import(gltf);
  expect_near(scene.patches[0].reflectance, {0.5, 0.25, 0.125});
  EXPECT_EQ(scene.materials[0].specular, Color(0.0f));
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("unlit materials are read as diffuse"));
}

TEST(Textures, MetalsAboveFullReflectanceAreRefusedByName) {
  Importer importer;
  write_row(importer.folder / "base.png", {{100, 100, 100, 255}});  // so that the mean specular reflectance is below 1
  GltfBuilder gltf = textured_square(
      {{"name", "chrome"},
       {"pbrMetallicRoughness",
        {{"metallicFactor", 1}, {"baseColorFactor", {2, 2, 2, 1}}, {"baseColorTexture", {{"index", 0}}}}}},
      {"base.png"});
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "chrome");
}

TEST(Textures, BrokenMappingsOfEveryTextureAreRefused) {
  Importer importer;
  write_row(importer.folder / "row.png", {{255, 255, 0, 255}});
  for (const char* slot : {"emissiveTexture", "metallicRoughnessTexture"}) {
    GltfBuilder gltf = textured_square({{"name", "sign"}, {"emissiveFactor", {1, 1, 1}}}, {"row.png"});
    Json& material = gltf.json["materials"][0];
    Json& owner = slot == std::string("emissiveTexture") ? material : material["pbrMetallicRoughness"];
    owner[slot] = {{"index", 0}, {"texCoord", 2}};
    gltf.primitive(0)["attributes"]["TEXCOORD_2"] =
        gltf.accessor(std::vector<Vec2f>{{0, 0}, {INFINITY, 0}, {0, 1}, {1, 1}}, 5126, "VEC2");
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "texture coordinate is not finite");
    owner[slot]["texCoord"] = -1;
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "texCoord");
  }
}

}  // namespace
}  // namespace patchlight::test
