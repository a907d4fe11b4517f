#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/formats/patches/patch_file.h"
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
                  bool with_coats = true, bool closed = false) {
  Imported result;
  result.importer.job.materials = changes;
  result.importer.job.import.dielectric_coat = with_coats;
  GltfBuilder gltf = single_mesh(
      closed ? cube() : grid(1),
      {{"name", "paint"}, {"pbrMetallicRoughness", {{"metallicFactor", metallic}, {"roughnessFactor", 0.3}}}});
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

Json glass(double factor, const Json& volume = kNone) {
  return {{"KHR_materials_transmission", {{"transmissionFactor", factor}}}, {"KHR_materials_volume", volume}};
}

TEST(GlassOfMaterials, SharesTheLightWithTheDiffusePart) {
  const Imported half = imported(glass(0.25), {}, 0.5);
  const Transmission& passed = half.material().transmission;
  EXPECT_FLOAT_EQ(passed.part, 0.125f) << "the metallic part lets nothing pass";
  EXPECT_FALSE(passed.solid);
  EXPECT_FLOAT_EQ(passed.ior, 1.5f);
  EXPECT_FALSE(imported(kNone).material().transmission.exists());
  EXPECT_FLOAT_EQ(imported(glass(1)).scene.patches[0].reflectance.x, 0.0f);
}

TEST(GlassOfMaterials, IsABodyWithAThickness) {
  Json extensions =
      glass(1, {{"thicknessFactor", 0.1}, {"attenuationDistance", 2.0}, {"attenuationColor", {0.5, 1.0, 0.25}}});
  extensions["KHR_materials_ior"] = {{"ior", 1.33}};
  const Imported water = imported(extensions, {}, 0, true, true);
  const Transmission& body = water.material().transmission;
  EXPECT_TRUE(body.solid);
  EXPECT_FLOAT_EQ(body.ior, 1.33f);
  expect_color(body.absorption, {std::log(2.0) / 2, 0.0, std::log(4.0) / 2});
  EXPECT_FALSE(imported(glass(1, {{"thicknessFactor", 0}}), {}, 0, true, true).material().transmission.solid);
}

TEST(GlassOfMaterials, OfOpenMeshesIsASheet) {
  const Imported square = imported(glass(1, {{"thicknessFactor", 0.1}}));
  const Material& used = square.scene.materials.at(square.scene.primitives[0].material);
  EXPECT_TRUE(used.transmission.exists());
  EXPECT_FALSE(used.transmission.solid);
  EXPECT_NE(square.importer.messages().find("glass of material 'paint' has a thickness"), std::string::npos);
}

TEST(GlassOfMaterials, GivesWayToTheJob) {
  MaterialOverride wall{"paint"}, mirror{"paint"};
  wall.reflectance = Color(0.5f);
  mirror.mirror = Color(0.5f);
  EXPECT_FALSE(imported(glass(1), {wall}).material().transmission.exists());
  EXPECT_FALSE(imported(glass(1), {mirror}).material().transmission.exists());
}

TEST(GlassOfMaterials, IsKeptInTheFile) {
  Imported water = imported(
      glass(0.75, {{"thicknessFactor", 0.1}, {"attenuationDistance", 2.0}, {"attenuationColor", {0.5, 1.0, 0.25}}}), {},
      0, true, true);
  const std::filesystem::path file = water.importer.folder / "patches.h5";
  write_patches(file, water.scene);
  const Transmission read = read_patches(file).materials.at(0).transmission;
  const Transmission& written = water.material().transmission;
  EXPECT_EQ(read.part, written.part);
  EXPECT_EQ(read.solid, written.solid);
  EXPECT_EQ(read.absorption, written.absorption);
  const std::string key = water.scene.geometry_key;
  water.scene.materials[0].transmission.ior = 1.4f;
  write_patches(file, water.scene);
  EXPECT_NE(water.scene.geometry_key, key) << "rows depend on it";
}

TEST(CoatsOfMaterials, OutOfRangeAreRefused) {
  const auto refuse = [](const Json& extensions, const char* text) {
    EXPECT_ERROR(imported(extensions), ExitCode::bad_data, text);
  };
  refuse({{"KHR_materials_specular", {{"specularFactor", 1.5}}}}, "specular factor");
  refuse({{"KHR_materials_specular", {{"specularColorFactor", {-1, 0, 0}}}}}, "specular colour");
  refuse({{"KHR_materials_ior", {{"ior", 0.5}}}}, "index of refraction");
  refuse({{"KHR_materials_ior", {{"ior", "glass"}}}}, "ior");
  refuse(glass(1.5), "transmission factor");
  refuse(glass(1, {{"thicknessFactor", 1}, {"attenuationDistance", 1}, {"attenuationColor", {2, 0, 0}}}),
         "attenuation colour");
}

Json clear(double part, double roughness) {
  return {{"KHR_materials_clearcoat", {{"clearcoatFactor", part}, {"clearcoatRoughnessFactor", roughness}}}};
}

/// All of an extension's numbers and colours are 1 and have textures.
TEST(LayersOfMaterials, HaveTheMeansOfTheirTextures) {
  Importer importer;
  write_row(importer.folder / "half.png", {{255, 0, 0, 255}, {0, 255, 0, 0}});  // linear means 1/2, 1/2, 0, alpha 1/2
  const Json texture{{"index", 0}};
  const auto material = [&](const Json& extensions) {
    GltfBuilder gltf = textured_square(
        {{"name", "paint"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}, {"extensions", extensions}},
        {"half.png"});
    return importer.import(gltf).materials.at(0);
  };
  const Material coated =
      material({{"KHR_materials_specular", {{"specularTexture", texture}, {"specularColorTexture", texture}}},
                {"KHR_materials_clearcoat",
                 {{"clearcoatFactor", 1},
                  {"clearcoatRoughnessFactor", 1},
                  {"clearcoatTexture", texture},
                  {"clearcoatRoughnessTexture", texture}}}});
  EXPECT_NEAR(coated.coat.grazing, 0.5, 1e-6);
  expect_color(coated.coat.normal, {0.01, 0.01, 0});
  EXPECT_NEAR(coated.clear_coat.part, 0.5, 1e-6);
  EXPECT_NEAR(coated.clear_coat.roughness, 0.5, 1e-6);
  const Json passing{{"diffuseTransmissionFactor", 1},
                     {"diffuseTransmissionTexture", texture},
                     {"diffuseTransmissionColorTexture", texture}};
  expect_color(material({{"KHR_materials_diffuse_transmission", passing}}).translucence, {0.25, 0.25, 0});
  EXPECT_NE(importer.messages().find("textures of KHR_materials_clearcoat are replaced by their means"),
            std::string::npos);
}

TEST(ClearCoatsOfMaterials, AreReadAndKept) {
  Imported paint = imported(clear(0.5, 0.25), {}, 1);
  EXPECT_FLOAT_EQ(paint.material().clear_coat.part, 0.5f);
  EXPECT_FLOAT_EQ(paint.material().clear_coat.roughness, 0.25f);
  EXPECT_FALSE(paint.coat().exists()) << "all metal";
  EXPECT_LT(paint.scene.patches[0].transmittance.x, 0.96f);
  const std::filesystem::path file = paint.importer.folder / "patches.h5";
  write_patches(file, paint.scene);
  EXPECT_FLOAT_EQ(read_patches(file).materials.at(0).clear_coat.part, 0.5f);

  MaterialOverride mirror{"paint"};
  mirror.mirror = Color(0.5f);
  EXPECT_FALSE(imported(clear(1, 0), {mirror}).material().clear_coat.exists());
  EXPECT_FALSE(imported(clear(1, 0), {}, 0, false).material().clear_coat.exists()) << "import.dielectric_coat: false";
  EXPECT_ERROR(imported(clear(1.5, 0)), ExitCode::bad_data, "its clear coat factor is 1.5");
  EXPECT_ERROR(imported(clear(1, -1)), ExitCode::bad_data, "its clear coat roughness is -1");
}

TEST(TranslucenceOfMaterials, SharesTheLightWithTheDiffusePart) {
  const Json cloth = {{"KHR_materials_diffuse_transmission",
                       {{"diffuseTransmissionFactor", 0.25}, {"diffuseTransmissionColorFactor", {1.0, 0.5, 0.0}}}}};
  Imported half = imported(cloth, {}, 0.5);
  expect_color(half.material().translucence, {0.125, 0.0625, 0.0});
  ASSERT_EQ(half.scene.primitives.size(), 2u) << "light passes to the other side, which is there";
  EXPECT_EQ(half.scene.primitives[0].back, 1);
  const float plain = imported(kNone, {}, 0.5).scene.patches[0].reflectance.x;
  EXPECT_FLOAT_EQ(half.scene.patches[0].reflectance.x, 0.75f * plain);

  const std::filesystem::path file = half.importer.folder / "patches.h5";
  write_patches(file, half.scene);
  EXPECT_EQ(read_patches(file).materials.at(0).translucence, half.material().translucence);

  MaterialOverride wall{"paint"};
  wall.reflectance = Color(0.9f);
  expect_color(imported(cloth, {wall}).material().translucence, {0, 0, 0});
}

TEST(TranslucenceOfMaterials, IsNoPartOfFormFactors) {
  const auto cloth = [](double part) {
    return Json{{"KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", part}}}};
  };
  Imported thin = imported(cloth(0.5)), thick = imported(cloth(0.25));
  for (Imported* scene : {&thin, &thick}) write_patches(scene->importer.folder / "patches.h5", scene->scene);
  EXPECT_EQ(thin.scene.geometry_key, thick.scene.geometry_key) << "a solve with the other one casts no rays";
  EXPECT_NE(thin.scene.key, thick.scene.key);
}

TEST(TranslucenceOfMaterials, IsRefusedBeyondOne) {
  const auto cloth = [](const char* key, const Json& value) {
    return Json{{"KHR_materials_diffuse_transmission", {{key, value}}}};
  };
  EXPECT_ERROR(imported(cloth("diffuseTransmissionFactor", 1.5)), ExitCode::bad_data,
               "its diffuse transmission factor is 1.5");
  EXPECT_ERROR(imported(cloth("diffuseTransmissionColorFactor", {0.5, 2.0, 0.5})), ExitCode::bad_data,
               "its diffuse transmission colour is 2");
}

}  // namespace
}  // namespace patchlight::test
