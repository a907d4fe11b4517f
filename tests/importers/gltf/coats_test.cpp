#include <gtest/gtest.h>

#include "pipeline/optics/surface/specular.h"
#include "tests/expect_error.h"
#include "tests/importers/expect_color.h"
#include "tests/importers/textured_square.h"

namespace patchlight::test {
namespace {

struct Imported {
  Importer importer;
  PatchSet scene;
  const Material& material() const { return scene.materials.at(0); }
  const Coat& coat() const { return material().coat; }
};

Imported imported(const Json& extensions, const std::vector<MaterialOverride>& changes = {}, double metallic = 0,
                  bool with_coats = true) {
  Imported result;
  result.importer.job.materials = changes;
  result.importer.job.import.dielectric_coat = with_coats;
  GltfBuilder gltf = single_mesh(
      grid(1), {{"name", "paint"}, {"pbrMetallicRoughness", {{"metallicFactor", metallic}, {"roughnessFactor", 0.3}}}});
  gltf.json["materials"][0]["extensions"] = extensions;
  result.scene = result.importer.import(gltf);
  return result;
}

const Json kNone = Json::object();

TEST(CoatsOfMaterials, HaveAnIndexOfOneAndAHalf) {
  const Imported square = imported(kNone);
  expect_color(square.coat().normal, {0.04, 0.04, 0.04});
  EXPECT_FLOAT_EQ(square.coat().grazing, 1.0f);
  EXPECT_FLOAT_EQ(square.coat().ior, 1.5f);
  EXPECT_FLOAT_EQ(square.material().roughness, 0.3f);
  EXPECT_LT(square.scene.patches[0].transmittance.x, 0.96f);
  EXPECT_GT(square.scene.patches[0].transmittance.x, 0.9f);
  EXPECT_NE(square.importer.messages().find("1 coated ones"), std::string::npos);
}

TEST(CoatsOfMaterials, FollowTheirExtensions) {
  const Imported dense = imported({{"KHR_materials_ior", {{"ior", 2.0}}}});
  expect_color(dense.coat().normal, {1.0 / 9, 1.0 / 9, 1.0 / 9});
  EXPECT_FLOAT_EQ(dense.coat().ior, 2.0f);
  const Imported weak = imported({{"KHR_materials_specular", {{"specularFactor", 0.5}}}});
  expect_color(weak.coat().normal, {0.02, 0.02, 0.02});
  EXPECT_FLOAT_EQ(weak.coat().grazing, 0.5f);
  const Imported tinted = imported({{"KHR_materials_specular", {{"specularColorFactor", {2.0, 1.0, 50.0}}}}});
  expect_color(tinted.coat().normal, {0.08, 0.04, 1.0});
  EXPECT_FLOAT_EQ(tinted.coat().ior, 0.0f) << "Schlick's curve";
  const Imported compatible = imported(
      {{"KHR_materials_ior", {{"ior", 0}}}, {"KHR_materials_specular", {{"specularColorFactor", {0.2, 0.2, 0.2}}}}});
  expect_color(compatible.coat().normal, {0.2, 0.2, 0.2});
}

TEST(CoatsOfMaterials, AreAbsentWhereNothingReflects) {
  for (const Json& extensions : {Json{{"KHR_materials_specular", {{"specularFactor", 0}}}},
                                 Json{{"KHR_materials_specular", {{"specularColorFactor", {0, 0, 0}}}}},
                                 Json{{"KHR_materials_ior", {{"ior", 1.0}}}}, Json{{"KHR_materials_unlit", kNone}}}) {
    const Imported square = imported(extensions);
    EXPECT_FALSE(square.coat().exists()) << extensions.dump();
    EXPECT_EQ(square.scene.patches[0].transmittance, Color(1.0f));
  }
  EXPECT_FALSE(imported(kNone, {}, 1.0).coat().exists()) << "metal";
  EXPECT_FALSE(imported(kNone, {}, 0.0, false).coat().exists()) << "import.dielectric_coat: false";
}

TEST(CoatsOfMaterials, LeaveOutTheMetallicPart) {
  const Imported half = imported(kNone, {}, 0.5);
  const SpecularProperties specular = specular_properties_at(half.scene, 0, 0.5, 0.5);
  expect_color(specular.coat, {0.02, 0.02, 0.02});
  expect_color(specular.metal, {0.5, 0.5, 0.5});
}

TEST(CoatsOfMaterials, FollowTheTextureOfRoughnessAndMetalness) {
  Importer importer;  // metal, not metal | half of each
  write_row(importer.folder / "finish.png",
            {{0, 51, 255, 255}, {0, 102, 0, 255}, {0, 153, 51, 255}, {0, 153, 51, 255}});
  GltfBuilder gltf = textured_square(
      {{"pbrMetallicRoughness",
        {{"metallicFactor", 1}, {"roughnessFactor", 0.5}, {"metallicRoughnessTexture", {{"index", 0}}}}}},
      {"finish.png"});
  gltf.json["materials"][0]["extensions"] = kNone;
  const PatchSet scene = importer.import(gltf);
  const auto at = [&](double x) {
    const Imath::V2d uv = uv_of(scene, 0, x, 0.5);
    return specular_properties_at(scene, 0, uv.x, uv.y);
  };
  expect_color(at(0.1).coat, {0, 0, 0});
  expect_color(at(0.3).coat, {0.04, 0.04, 0.04});
  EXPECT_NEAR(at(0.3).roughness, 0.2, 1e-5);
  expect_color(at(0.6).coat, {0.032, 0.032, 0.032});
}

TEST(CoatsOfMaterials, FollowTheJob) {
  MaterialOverride none{"paint"}, dense{"paint"}, smooth{"paint"}, mirror{"paint"};
  none.specular = 0.0;
  dense.ior = 2.0;
  smooth.roughness = 0.0;
  mirror.mirror = Color(0.5f);
  EXPECT_FALSE(imported(kNone, {none}).coat().exists());
  expect_color(imported(kNone, {dense}).coat().normal, {1.0 / 9, 1.0 / 9, 1.0 / 9});
  EXPECT_FLOAT_EQ(imported(kNone, {smooth}).material().roughness, 0.0f);
  EXPECT_FALSE(imported(kNone, {mirror}).coat().exists());
}

TEST(CoatsOfMaterials, OutOfRangeAreRefused) {
  const auto refuse = [](const Json& extensions, const char* text) {
    EXPECT_ERROR(imported(extensions), ExitCode::bad_data, text);
  };
  refuse({{"KHR_materials_specular", {{"specularFactor", 1.5}}}}, "specular factor");
  refuse({{"KHR_materials_specular", {{"specularColorFactor", {-1, 0, 0}}}}}, "specular colour");
  refuse({{"KHR_materials_ior", {{"ior", 0.5}}}}, "index of refraction");
  refuse({{"KHR_materials_ior", {{"ior", "glass"}}}}, "ior");
}

}  // namespace
}  // namespace patchlight::test
