#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/expect_error.h"
#include "tests/importers/expect_color.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// The imported scene of one square with a material.
struct Imported {
  Importer importer;
  PatchSet scene;

  Imported(const Json& material, const Json& node, const std::vector<MaterialOverride>& changes) {
    importer.job.materials = changes;
    GltfBuilder gltf = single_mesh(grid(1), material, node);
    scene = importer.import(gltf);
  }
  const Patch& patch() const { return scene.patches.at(0); }
  const Material& material() const { return scene.materials.at(0); }
};

Imported imported(const Json& material, const Json& node = Json::object(),
                  const std::vector<MaterialOverride>& changes = {}) {
  return Imported(material, node, changes);
}

MaterialOverride change(const std::string& pattern) {
  return {pattern};
}

TEST(Materials, MetallicSplitsBaseColourIntoDiffuseAndSpecular) {
  const Imported square =
      imported({{"name", "brass"},
                {"pbrMetallicRoughness",
                 {{"baseColorFactor", {0.8, 0.4, 0.2, 1}}, {"metallicFactor", 0.25}, {"roughnessFactor", 0.5}}}});
  expect_color(square.patch().reflectance, {0.6, 0.3, 0.15});
  expect_color(square.material().specular, {0.2, 0.1, 0.05});
  EXPECT_FLOAT_EQ(square.material().roughness, 0.5f);
  EXPECT_EQ(square.material().name, "brass");
}

TEST(Materials, GltfDefaultsAreAWhiteRoughMetal) {
  const Imported square = imported({{"name", "bare"}});
  expect_color(square.patch().reflectance, {0, 0, 0});
  expect_color(square.material().specular, {1, 1, 1});
  EXPECT_FLOAT_EQ(square.material().roughness, 1.0f);
}

TEST(Materials, SurfacesWithoutMaterialAreDiffuseGreyWithAWarning) {
  Importer importer;
  GltfBuilder gltf = single_mesh(grid(1));
  const PatchSet scene = importer.import(gltf);
  expect_color(scene.patches.at(0).reflectance, {0.8, 0.8, 0.8});
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].name, "default");
  expect_color(scene.materials[0].specular, {0, 0, 0});
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("without a material"));
}

TEST(Materials, EmissionIsPiTimesFactorTimesStrength) {
  const Imported lamp = imported({{"name", "lamp"},
                                  {"emissiveFactor", {1, 0.5, 0.25}},
                                  {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}});
  expect_color(lamp.patch().emission, {8 * kPi, 4 * kPi, 2 * kPi});
}

TEST(Materials, LightGroupComesFromNodeThenMaterialThenName) {
  const Json plain{{"name", "lights/lamp"}, {"emissiveFactor", {1, 1, 1}}};
  Json grouped = plain;
  grouped["extras"] = {{"light_group", "hall"}};
  EXPECT_EQ(imported(plain).scene.light_groups, std::vector<std::string>{"lights_lamp"});
  EXPECT_EQ(imported(grouped).scene.light_groups, std::vector<std::string>{"hall"});
  EXPECT_EQ(imported(grouped, {{"extras", {{"light_group", "a/b"}}}}).scene.light_groups,
            std::vector<std::string>{"a_b"});
  EXPECT_EQ(imported({{"emissiveFactor", {1, 1, 1}}}).scene.light_groups, std::vector<std::string>{"default"});
  EXPECT_EQ(imported(plain).scene.primitives[0].light_group, 0);
}

TEST(Materials, LightGroupNamesAreValidInFiles) {
  const auto group = [](const std::string& name) {
    return imported({{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}, {"extras", {{"light_group", name}}}})
        .scene.light_groups[0];
  };
  EXPECT_EQ(group("."), "_");
  EXPECT_EQ(group(".."), "..");
  EXPECT_EQ(group("a\tb"), "a\tb");
  EXPECT_EQ(group(std::string(1024, 'x')).size(), 1024u);
  EXPECT_ERROR(group(std::string(1025, 'x')), ExitCode::bad_data, "node ");
}

TEST(Materials, NonEmittingSurfacesHaveNoLightGroup) {
  const Imported wall = imported({{"name", "wall"}}, {{"extras", {{"light_group", "hall"}}}});
  EXPECT_TRUE(wall.scene.light_groups.empty());
  EXPECT_EQ(wall.scene.primitives[0].light_group, -1);
}

TEST(Materials, PerfectReflectanceIsLoweredWithAWarning) {
  const Imported white = imported({{"name", "snow"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  EXPECT_EQ(white.patch().reflectance, Color(0.99999f));
  EXPECT_THAT(white.importer.messages(), ::testing::HasSubstr("snow"));
}

TEST(Materials, ValuesOutOfRangeAreRefusedByName) {
  const auto with_base = [](const std::vector<double>& color) {
    return Json{{"name", "odd"}, {"pbrMetallicRoughness", {{"baseColorFactor", color}, {"metallicFactor", 0}}}};
  };
  EXPECT_ERROR(imported(with_base({1.2, 0, 0, 1})), ExitCode::bad_data, "odd");
  EXPECT_ERROR(imported(with_base({-0.1, 0, 0, 1})), ExitCode::bad_data, "odd");
  EXPECT_ERROR(imported({{"name", "odd"}, {"emissiveFactor", {-1, 0, 0}}}), ExitCode::bad_data, "odd");
  EXPECT_ERROR(imported({{"name", "odd"}, {"pbrMetallicRoughness", {{"metallicFactor", 1.5}}}}), ExitCode::bad_data,
               "odd");
  EXPECT_ERROR(imported({{"name", "odd"},
                         {"emissiveFactor", {1, 1, 1}},
                         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e300}}}}}}),
               ExitCode::bad_data, "odd");
}

TEST(Materials, JobOverridesMatchingMaterials) {
  MaterialOverride walls = change("wall_*");
  walls.reflectance = Color(0.1f, 0.2f, 0.3f);
  walls.emission = Color(5.0f);
  const Imported wall =
      imported({{"name", "wall_red"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}}, {}, {walls});
  expect_color(wall.patch().reflectance, {0.1, 0.2, 0.3});
  expect_color(wall.patch().emission, {5, 5, 5});
  EXPECT_EQ(wall.scene.light_groups, std::vector<std::string>{"wall_red"});
}

TEST(Materials, OverrideCanCorrectAValueOutOfRange) {
  MaterialOverride mend = change("odd");
  mend.reflectance = Color(0.5f);
  const Json bad{{"name", "odd"}, {"pbrMetallicRoughness", {{"baseColorFactor", {2, 2, 2, 1}}, {"metallicFactor", 0}}}};
  EXPECT_EQ(imported(bad, {}, {mend}).patch().reflectance, Color(0.5f));
}

TEST(Materials, MirrorOverrideReducesTheDiffusePart) {
  MaterialOverride mirror = change("glass");
  mirror.mirror = Color(0.9f);
  const Imported glass = imported(
      {{"name", "glass"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.05, 0.5, 1}}, {"metallicFactor", 0}}}},
      {}, {mirror});
  expect_color(glass.material().specular, {0.9, 0.9, 0.9});
  EXPECT_EQ(glass.material().roughness, 0.0f);
  expect_color(glass.patch().reflectance, {0.1, 0.05, 0.1});
}

TEST(Materials, MirrorAndReflectanceAboveOneAreBadConfig) {
  MaterialOverride both = change("glass");
  both.mirror = Color(0.9f);
  both.reflectance = Color(0.2f);
  EXPECT_ERROR(imported({{"name", "glass"}}, {}, {both}), ExitCode::bad_config, "materials.glass");
}

/// Two emissive unit squares on nodes `left` and `right` with a light group, and a plain one on node `floor`.
GltfBuilder lamps() {
  GltfBuilder gltf;
  const int lamp = gltf.material(
      {{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  const int plain = gltf.material({{"name", "plain"}});
  const int square = gltf.mesh(grid(1), lamp);
  for (const char* name : {"left", "right"})
    gltf.node({{"name", name}, {"mesh", square}, {"extras", {{"light_group", "file"}}}});
  gltf.node({{"name", "floor"}, {"mesh", gltf.mesh(grid(1), plain)}});
  return gltf;
}

TEST(Materials, JobOverridesMaterialsOfANode) {
  Importer importer;
  GltfBuilder gltf = lamps();
  MaterialOverride material = change("lamp"), left = change("le*");
  material.emission = Color(2.0f);
  left.emission = Color(5.0f);
  left.reflectance = Color(0.25f);
  left.light_group = "mine";
  importer.job.materials = {material};
  importer.job.nodes = {left};
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.light_groups, (std::vector<std::string>{"mine", "file"}));
  for (const Patch& patch : scene.patches) {
    const std::string& node = scene.nodes[scene.primitives[patch.primitive].node];
    EXPECT_EQ(patch.emission, Color(node == "left" ? 5.0f : node == "right" ? 2.0f : 0.0f));
    if (node == "left") {
      EXPECT_EQ(patch.reflectance, Color(0.25f));
    }
  }
  EXPECT_EQ(scene.materials[std::size_t(scene.primitives[0].material)].name, "lamp");

  importer.job.materials[0].light_group = "all";
  EXPECT_EQ(importer.import(gltf).light_groups, (std::vector<std::string>{"mine", "all"}));
  importer.job.nodes = {change("nothing")};
  importer.import(gltf);
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("nodes.nothing in the job matches no node"));
}

TEST(Materials, JobExcludesMaterialsAndNodes) {
  Importer importer;
  GltfBuilder gltf = lamps();
  const auto nodes_left = [&] {
    std::set<std::string> nodes;
    const PatchSet scene = importer.import(gltf);
    for (const Primitive& p : scene.primitives) nodes.insert(scene.nodes[p.node]);
    return nodes;
  };
  MaterialOverride all = change("*"), left = change("left"), lamp = change("lamp");
  all.exclude = lamp.exclude = true;
  left.exclude = false;
  importer.job.materials = {lamp};
  EXPECT_EQ(nodes_left(), std::set<std::string>{"floor"});
  importer.job.materials.clear();
  importer.job.nodes = {all, left};
  EXPECT_EQ(nodes_left(), std::set<std::string>{"left"});
  importer.job.nodes = {all};
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "no surface with an area");
}

TEST(Materials, JobSetsPatchAreaOfMaterialsAndNodes) {
  Importer importer;
  GltfBuilder gltf = lamps();
  MaterialOverride lamp = change("lamp"), right = change("right");
  importer.job.import.patch_area = 1.0;
  lamp.patch_area = 1.0 / 16;
  right.patch_area = 1.0 / 4;
  importer.job.materials = {lamp};
  importer.job.nodes = {right};
  const PatchSet scene = importer.import(gltf);
  std::map<std::string, int> patches;
  for (const Patch& patch : scene.patches) ++patches[scene.nodes[scene.primitives[patch.primitive].node]];
  EXPECT_EQ(patches, (std::map<std::string, int>{{"left", 16}, {"right", 4}, {"floor", 1}}));
  importer.job.import.max_patches = 20;
  EXPECT_ERROR(importer.import(gltf), ExitCode::over_limit, "patch_area of materials and nodes");
}

TEST(Materials, PatternWithoutMatchGivesAWarning) {
  EXPECT_THAT(imported({{"name", "wall"}}, {}, {change("wal")}).importer.messages(),
              ::testing::HasSubstr("materials.wal "));
}

}  // namespace
}  // namespace patchlight::test
