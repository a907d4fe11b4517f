#include <gtest/gtest.h>

#include "importers/import.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

Json sheet(const Json& more = Json::object()) {
  Json material{{"name", "sheet"}, {"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}};
  material.update(more);
  return material;
}

std::size_t primitives_of(GltfBuilder gltf) {
  Importer importer;
  return importer.import(gltf).primitives.size();
}

TEST(HiddenBacks, OfClosedMeshesAreLeftOut) {
  EXPECT_EQ(primitives_of(single_mesh(cube(), sheet())), 6u);
  EXPECT_EQ(primitives_of(single_mesh(uv_sphere(32, 16), sheet())), 1u);
}

TEST(HiddenBacks, AreKeptWhereLightReachesThem) {
  EXPECT_EQ(primitives_of(single_mesh(inverted(cube()), sheet())), 12u) << "a room";
  EXPECT_EQ(primitives_of(single_mesh(truncated(cube(), 10), sheet())), 10u) << "open: four quads and a triangle";
  const Json lamp{{"emissiveFactor", {1, 1, 1}}};
  EXPECT_EQ(primitives_of(single_mesh(cube(), sheet(lamp))), 12u);
  Json veil = sheet({{"alphaMode", "BLEND"}});
  veil["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  EXPECT_EQ(primitives_of(single_mesh(cube(), veil)), 12u);
  const Json passing{{"extensions", {{"KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 0.5}}}}}};
  EXPECT_EQ(primitives_of(single_mesh(cube(), sheet(passing))), 12u);
}

TEST(HiddenBacks, AreKeptAroundWhatIsInside) {
  GltfBuilder contents = single_mesh(cube(), sheet());
  contents.node({{"mesh", contents.mesh(grid(1), 0)}, {"scale", {0.1, 0.1, 0.1}}, {"translation", {0.1, 0.2, 0.3}}});
  EXPECT_EQ(primitives_of(contents), 14u);
  GltfBuilder lit = single_mesh(cube(), sheet());
  lit.node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"translation", {0.1, 0.2, 0.3}}});
  lit.json["extensionsUsed"] = {"KHR_lights_punctual"};
  lit.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  EXPECT_EQ(primitives_of(lit), 12u);
}

/// A cube and a square, in whose plane a side of the cube is, or which cuts the cube.
TEST(HiddenBacks, MayTouchOtherSurfaces) {
  const PatchSet alone = [] {
    Importer importer;
    GltfBuilder gltf = single_mesh(cube(), sheet());
    return importer.import(gltf);
  }();
  const Imath::Box3d box = bounds_of(alone.primitives);
  for (const double depth : {0.0, 0.1}) {
    GltfBuilder gltf = single_mesh(cube(), sheet());
    gltf.node({{"mesh", gltf.mesh(grid(1), 0)},
               {"scale", {8, 8, 8}},
               {"translation", {box.min.x - 1, box.min.y - 1, box.min.z + depth}}});
    EXPECT_EQ(primitives_of(gltf), depth > 0 ? 14u : 8u);
  }
}

}  // namespace
}  // namespace patchlight::test
