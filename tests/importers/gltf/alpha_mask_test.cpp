#include "pipeline/optics/intersect/alpha_mask.h"

#include <gtest/gtest.h>

#include "pipeline/formats/patches/patch_file.h"
#include "tests/expect_error.h"
#include "tests/importers/textured_square.h"

namespace patchlight::test {
namespace {

const Json kLeaf{
    {"name", "leaf"},
    {"alphaMode", "MASK"},
    {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}},
};

/// A square with four texels along x: opaque red, transparent green, blue of alpha 128, white of alpha 127.
struct Leaf {
  Importer importer;
  GltfBuilder gltf;

  explicit Leaf(const Json& material = kLeaf, double patch_area = 1.0 / 16)
      : gltf(textured_square(material, {"leaf.png"})) {
    importer.job.import.patch_area = patch_area;
    write_row(importer.folder / "leaf.png", {{255, 0, 0, 255}, {0, 255, 0, 0}, {0, 0, 255, 128}, {255, 255, 255, 127}});
  }
  PatchSet import() { return importer.import(gltf); }
};

TEST(AlphaMasks, PatchesAverageTheOpaquePart) {
  Leaf leaf(kLeaf, 1.0 / 4);  // two by two patches
  const PatchSet scene = leaf.import();
  ASSERT_EQ(scene.masks.size(), 1u);
  EXPECT_EQ(scene.masks[0].texels, (std::vector<std::int32_t>{255, 0, 128, 127}));
  EXPECT_EQ(scene.primitives[0].mask, 0);
  EXPECT_FLOAT_EQ(scene.materials[0].alpha_cutoff, 0.5f);
  EXPECT_NEAR(total_area(scene), 1, 1e-6);
  EXPECT_NEAR(patch_at(scene, 0.25).coverage, 0.5, 0.01);
  EXPECT_NEAR(patch_at(scene, 0.25).reflectance.x, 0.99999, 1e-5);
  EXPECT_NEAR(patch_at(scene, 0.25).reflectance.y, 0, 1e-6);
  EXPECT_NEAR(patch_at(scene, 0.75).coverage, 0.5, 0.01);
  EXPECT_NEAR(patch_at(scene, 0.75).reflectance.z, 0.99999, 1e-5);
  EXPECT_NEAR(patch_at(scene, 0.75).reflectance.x, 0, 1e-6);
}

TEST(AlphaMasks, AlphaFactorAndCutoffApply) {
  Leaf leaf;
  leaf.gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  leaf.gltf.json["materials"][0]["alphaCutoff"] = 0.25;
  EXPECT_EQ(patch_at(leaf.import(), 0.625).coverage, 1);       // 0.251
  EXPECT_LT(patch_at(leaf.import(), 0.875).coverage, 0.002f);  // 0.249
  leaf.gltf.json["materials"][0]["alphaCutoff"] = 0.0;
  EXPECT_TRUE(leaf.import().masks.empty());
  leaf.gltf.json["materials"][0]["alphaCutoff"] = 0.75;
  EXPECT_ERROR(leaf.import(), ExitCode::bad_data, "no surface with an area");
  EXPECT_THAT(leaf.importer.messages(), ::testing::HasSubstr("material 'leaf' are skipped: their alpha"));
  leaf.gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, -1};
  EXPECT_ERROR(leaf.import(), ExitCode::bad_data, "leaf");
}

TEST(AlphaMasks, BlendCoversPlacesInPart) {
  Leaf leaf;
  leaf.gltf.json["materials"][0]["alphaMode"] = "BLEND";
  leaf.gltf.json["materials"][0]["alphaCutoff"] = 0.9;
  const PatchSet scene = leaf.import();
  EXPECT_FLOAT_EQ(scene.materials[0].alpha_cutoff, 0.0f);
  EXPECT_NEAR(patch_at(scene, 0.625).coverage, 128 / 255.0, 0.02);
  EXPECT_NEAR(patch_at(scene, 0.125).coverage, 1, 0.01);
  EXPECT_TRUE(lets_light_pass(scene, scene.primitives[0]));
  EXPECT_THAT(leaf.importer.messages(), ::testing::Not(::testing::HasSubstr("BLEND")));
  leaf.gltf.json["materials"][0]["alphaMode"] = "GLASS";
  EXPECT_ERROR(leaf.import(), ExitCode::bad_data, "alphaMode");
}

TEST(AlphaMasks, BlendNeedsNoTexture) {
  const Json veil{{"name", "veil"},
                  {"alphaMode", "BLEND"},
                  {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {1, 1, 1, 0.25}}}}};
  Leaf leaf(veil);
  leaf.gltf.primitive(0)["attributes"].erase("TEXCOORD_0");
  const PatchSet scene = leaf.import();
  ASSERT_EQ(scene.primitives[0].mask, 0);
  EXPECT_NEAR(patch_at(scene, 0.375).coverage, 0.25, 0.02);
  EXPECT_FLOAT_EQ(alpha_at(scene, 0, 0.5, 0.5), 0.25f);
  leaf.gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3] = 1;
  EXPECT_EQ(leaf.import().primitives[0].mask, -1) << "opaque";
  leaf.gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3] = 0;
  EXPECT_ERROR(leaf.import(), ExitCode::bad_data, "no surface with an area");
}

TEST(AlphaMasks, OpaqueSurfacesHaveNoMask) {
  Leaf opaque;
  opaque.gltf.json["materials"][0].erase("alphaMode");
  EXPECT_TRUE(opaque.import().masks.empty());
  Leaf full;
  write_row(full.importer.folder / "leaf.png", {{255, 0, 0, 255}, {0, 255, 0, 130}});
  EXPECT_TRUE(full.import().masks.empty());
  Leaf unmapped;
  unmapped.gltf.primitive(0)["attributes"].erase("TEXCOORD_0");
  EXPECT_EQ(unmapped.import().primitives[0].mask, -1);
}

TEST(AlphaMasks, BothSidesHaveTheSameMask) {
  Leaf leaf;
  leaf.gltf.json["materials"][0]["doubleSided"] = true;
  const PatchSet scene = leaf.import();
  ASSERT_EQ(scene.primitives.size(), 2u);
  for (const double x : {0.125, 0.375, 0.625, 0.875})
    EXPECT_EQ(patch_at(scene, x, 0).coverage, patch_at(scene, x, 1).coverage) << x;
  EXPECT_EQ(patch_at(scene, 0.125, 1).coverage, 1);
  EXPECT_LT(patch_at(scene, 0.375, 1).coverage, 0.002f);
}

TEST(AlphaMasks, VertexAlphaIsTestedToo) {
  const Json plain{{"name", "veil"}, {"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}};
  Leaf veil(plain);
  veil.gltf.primitive(0)["attributes"]["COLOR_0"] =
      veil.gltf.accessor(std::vector<Vec4f>{{1, 0, 0, 0}, {1, 0, 0, 1}, {1, 0, 0, 0}, {1, 0, 0, 1}}, 5126, "VEC4");
  const PatchSet scene = veil.import();
  const auto opaque = [&](double x) {
    const Imath::V2d uv = uv_of(scene, 0, x, 0.5);
    return passes_alpha_test(scene, 0, uv.x, uv.y);
  };
  EXPECT_FALSE(opaque(0.49));
  EXPECT_TRUE(opaque(0.51));
  EXPECT_EQ(patch_at(scene, 0.625).coverage, 1);
  EXPECT_NEAR(patch_at(scene, 0.625).reflectance.y, 0, 1e-6);
  veil.importer.job.materials = {{"veil"}};
  veil.importer.job.materials[0].reflectance = Color(0.25f);
  EXPECT_EQ(patch_at(veil.import(), 0.625).reflectance, Color(0.25f));
  EXPECT_LT(patch_at(veil.import(), 0.375).coverage, 0.002f);
}

TEST(AlphaMasks, MaskChangesTheGeometryKeyColourDoesNot) {
  Leaf leaf;
  const auto keys = [&] {
    PatchSet scene = leaf.import();
    write_patches(leaf.importer.folder / "patches.h5", scene);
    const PatchSet read = read_patches(leaf.importer.folder / "patches.h5");
    EXPECT_EQ(read.masks[0].texels, scene.masks[0].texels);
    EXPECT_EQ(read.patches[5].coverage, scene.patches[5].coverage);
    return std::pair(scene.geometry_key, scene.key);
  };
  const auto first = keys();
  leaf.gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1, 1, 1};
  const auto tinted = keys();
  EXPECT_EQ(tinted.first, first.first);
  EXPECT_NE(tinted.second, first.second);
  write_row(leaf.importer.folder / "leaf.png", {{255, 0, 0, 255}, {0, 255, 0, 0}, {0, 0, 255, 0}, {255, 255, 255, 0}});
  EXPECT_NE(keys().first, first.first);
}

}  // namespace
}  // namespace patchlight::test
