#include "importers/gltf/check/gltf_check.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// Imports a cube with modified JSON, and expects an error whose text contains `text`.
void expect_refused(const std::function<void(Json&)>& modify, const std::string& text) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), {{"name", "paint"}}, {{"name", "box"}});
  gltf.glb();  // fills in the buffer
  modify(gltf.json);
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, text);
}

TEST(GltfCheck, VersionsOtherThanTwoAreRefused) {
  expect_refused([](Json& json) { json["asset"]["version"] = "1.0"; }, "1.0");
  expect_refused([](Json& json) { json.erase("asset"); }, "asset.version");
  expect_refused([](Json& json) { json["asset"] = 2; }, "asset");
}

TEST(GltfCheck, UnknownRequiredExtensionIsNamed) {
  expect_refused([](Json& json) { json["extensionsRequired"] = {"EXT_texture_avif"}; }, "EXT_texture_avif");
}

TEST(GltfCheck, IgnoredOcclusionTexturesAreSaidOnce) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), {{"occlusionTexture", {{"index", 0}}}});
  gltf.material({{"occlusionTexture", {{"index", 0}}}});
  importer.import(gltf);
  const std::string messages = importer.messages(), text = "occlusion textures are ignored";
  EXPECT_NE(messages.find(text), std::string::npos);
  EXPECT_EQ(messages.find(text), messages.rfind(text));
}

TEST(GltfCheck, KnownRequiredAndUnknownUsedExtensionsPass) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  gltf.json["extensionsRequired"] = {"KHR_materials_emissive_strength", "KHR_materials_ior"};
  gltf.json["extensionsUsed"] = {"EXT_of_another_world", "KHR_materials_ior", "KHR_materials_sheen",
                                 "KHR_materials_transmission"};
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
  const std::string messages = importer.messages();
  EXPECT_THAT(messages, ::testing::HasSubstr("ignored: EXT_of_another_world, KHR_materials_sheen\""));
}

TEST(GltfCheck, IndicesOutOfRangeAreRefused) {
  expect_refused([](Json& json) { json["nodes"][0]["mesh"] = 1; }, "nodes[0] 'box'.mesh");
  expect_refused([](Json& json) { json["nodes"][0]["mesh"] = -1; }, "mesh");
  expect_refused([](Json& json) { json["nodes"][0]["mesh"] = "0"; }, "mesh");
  expect_refused([](Json& json) { json["nodes"][0]["children"] = {7}; }, "children");
  expect_refused([](Json& json) { json["scene"] = 3; }, "scene");
  expect_refused([](Json& json) { json["scenes"][0]["nodes"] = {5}; }, "scenes[0]");
  expect_refused([](Json& json) { json["meshes"][0]["primitives"][0]["material"] = 1; }, "material");
  expect_refused([](Json& json) { json["meshes"][0]["primitives"][0]["indices"] = 99; }, "indices");
  expect_refused([](Json& json) { json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99; }, "POSITION");
  expect_refused([](Json& json) { json["accessors"][0]["bufferView"] = 9; }, "accessors[0]");
  expect_refused([](Json& json) { json["bufferViews"][0]["buffer"] = 1; }, "bufferViews[0]");
  expect_refused([](Json& json) { json["materials"][0]["emissiveTexture"] = {{"index", 0}}; }, "'paint'");
}

TEST(GltfCheck, DataBeyondItsContainerIsRefused) {
  expect_refused([](Json& json) { json["accessors"][0]["count"] = 9; }, "accessors[0]");
  expect_refused([](Json& json) { json["accessors"][0]["count"] = 4611686018427387904; }, "accessors[0]");
  expect_refused([](Json& json) { json["accessors"][0]["count"] = 768614336404564651; }, "accessors[0]");
  expect_refused([](Json& json) { json["accessors"][0]["byteOffset"] = 4; }, "accessors[0]");
  expect_refused([](Json& json) { json["accessors"][0]["byteOffset"] = 9007199254740991; }, "accessors[0]");
  expect_refused([](Json& json) { json["bufferViews"][0]["byteStride"] = 16; }, "accessors[0]");
  expect_refused([](Json& json) { json["bufferViews"][0]["byteStride"] = 13; }, "byteStride");
  expect_refused([](Json& json) { json["bufferViews"][1]["byteLength"] = 1000000; }, "bufferViews[1]");
  expect_refused([](Json& json) { json["bufferViews"][1]["byteOffset"] = 9007199254740991; }, "bufferViews[1]");
  expect_refused([](Json& json) { json["buffers"][0]["byteLength"] = 1000000; }, "buffers[0]");
}

TEST(GltfCheck, WrongTypesAreRefused) {
  expect_refused([](Json& json) { json["nodes"] = 5; }, "nodes");
  expect_refused([](Json& json) { json["nodes"][0] = 5; }, "nodes[0]");
  expect_refused([](Json& json) { json["nodes"][0]["matrix"] = {1, 2, 3}; }, "matrix");
  expect_refused([](Json& json) { json["nodes"][0]["scale"] = {1, "2", 3}; }, "scale");
  expect_refused([](Json& json) { json["nodes"][0]["name"] = 1; }, "name");
  expect_refused([](Json& json) { json["accessors"][0]["type"] = "VEC9"; }, "accessors[0]");
  expect_refused([](Json& json) { json["accessors"][0]["componentType"] = 5123; }, "POSITION");
  expect_refused([](Json& json) { json["accessors"][1]["componentType"] = 5126; }, "indices");
  expect_refused([](Json& json) { json["meshes"][0].erase("primitives"); }, "meshes[0]");
  expect_refused([](Json& json) { json["meshes"][0]["primitives"][0].erase("attributes"); }, "meshes[0]");
  expect_refused([](Json& json) { json["meshes"][0]["primitives"][0]["mode"] = 7; }, "mode");
  expect_refused([](Json& json) { json["materials"][0]["doubleSided"] = 1; }, "doubleSided");
  expect_refused([](Json& json) { json["materials"][0]["emissiveFactor"] = {1, 1}; }, "emissiveFactor");
}

TEST(GltfCheck, NodesMustBeTrees) {
  const auto with_children = [](const std::vector<std::vector<int>>& children) {
    return [children](Json& json) {
      for (std::size_t i = 0; i < children.size(); ++i) json["nodes"][i]["children"] = children[i];
    };
  };
  expect_refused(with_children({{0}}), "nodes[0] 'box'");
  expect_refused(with_children({{1}, {2}, {1}}), "two parents");
  expect_refused(with_children({{}, {2}, {3}, {1}}), "own ancestor");
  expect_refused(with_children({{2}, {2}, {}}), "two parents");
  expect_refused(with_children({{}, {0}}), "not a root node");
}

TEST(GltfCheck, DeepJsonIsRefusedWithoutRecursion) {
  Importer importer;
  const std::string depth(5'000'000, '[');
  EXPECT_ERROR(importer.import_bytes(R"({"asset":{"version":"2.0"},"extras":)" + depth), ExitCode::bad_data, "nests");
  EXPECT_ERROR(importer.import_bytes(depth), ExitCode::bad_data, "nests");
}

TEST(GltfCheck, BracketsInTextDoNotNest) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), nullptr, {{"name", std::string(1000, '[') + "\"\\"}});
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
}

TEST(GltfCheck, DeepNodeChainIsTraversedWithoutRecursion) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  for (int i = 0; i < 100000; ++i) gltf.json["nodes"].push_back({{"children", {i}}});
  gltf.json["scenes"][0]["nodes"] = {100000};
  EXPECT_EQ(importer.import(gltf).primitives.size(), 6u);
}

TEST(GltfCheck, NumbersThatOverflowAreRefused) {
  Importer importer;
  EXPECT_ERROR(importer.import_bytes(R"({"asset":{"version":"2.0"},"nodes":[{"scale":[1e999,1,1]}]})"),
               ExitCode::bad_data, "overflow");
}

}  // namespace
}  // namespace patchlight::test
