#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/formats/patches/patch_check.h"
#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

const Json kWall{{"name", "wall"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}};

Shader reflecting(const std::string& name, const ColorExpressions& color) {
  return {name, color, {}};
}

Shader emitting(const std::string& name, const std::string& red) {
  return {name, {}, {red, "1", "0"}};
}

/// A unit square of 4 x 4 patches on node `square`.
struct Square : Importer {
  GltfBuilder gltf;

  explicit Square(const Json& material = kWall) : gltf(single_mesh(grid(1), material, {{"name", "square"}})) {
    job.file = "job.yaml";
    job.import.patch_area = 1.0 / 16;
  }
  void texcoords(const std::vector<float>& uv) {
    gltf.primitive(0)["attributes"]["TEXCOORD_0"] = gltf.accessor(uv, 5126, "VEC2");
    gltf.json["accessors"].back()["count"] = uv.size() / 2;
  }
  PatchSet shaded(const Shader& shader) {
    job.shaders = {shader};
    PatchSet scene = import(gltf);
    EXPECT_FALSE(find_fault(scene));
    return scene;
  }
};

/// Mean between two points of the function with this antiderivative.
template <class Function>
double mean(const Function& antiderivative, double from, double to) {
  return (antiderivative(to) - antiderivative(from)) / (to - from);
}

TEST(Shaders, PatchesHoldMeansOverTheirAreas) {
  Square square;
  const PatchSet scene = square.shaded(reflecting("wall", {"(1+cos(4*pi*u))/2", "x*y", "x > 0.3 ? 0.8 : 0.2"}));
  ASSERT_EQ(scene.patches.size(), 16u);
  const auto wave = [](double u) { return u / 2 + std::sin(4 * kPi * u) / (8 * kPi); };
  const auto step = [](double x) { return x < 0.3 ? 0.2 * x : 0.06 + 0.8 * (x - 0.3); };
  for (const Patch& patch : scene.patches) {
    EXPECT_NEAR(patch.reflectance.x, mean(wave, patch.u0, patch.u1), 1e-4);
    EXPECT_NEAR(patch.reflectance.y, patch.center.x * patch.center.y, 1e-4);
    EXPECT_NEAR(patch.reflectance.z, mean(step, patch.center.x - 0.125, patch.center.x + 0.125), 2e-3);
  }
}

TEST(Shaders, MeansOverTrianglesAndSpheresAreWeightedByArea) {
  Importer importer;
  importer.job.import.patch_area = 1e9;
  importer.job.shaders = {reflecting("*", {"max(x, 0)", "v", "(1 + ny)/2"})};
  GltfBuilder triangle = single_mesh({{{0, 0, 0}, {0.3f, 0, 0}, {0, 0.9f, 0}}, {0, 1, 2}, {}}, kWall);
  EXPECT_NEAR(importer.import(triangle).patches.at(0).reflectance.x, 0.1, 1e-4);

  GltfBuilder sphere = single_mesh(uv_sphere(32, 16), kWall);
  const PatchSet scene = importer.import(sphere);
  double ny = 0, v = 0;
  for (const Patch& patch : scene.patches) {
    ny += patch.reflectance.z * patch.area / total_area(scene);
    v += patch.reflectance.y * patch.area / total_area(scene);
  }
  EXPECT_NEAR(ny, 0.5, 1e-4);
  EXPECT_NEAR(v, 0.5, 1e-3);
  EXPECT_NEAR(scene.patches.at(0).reflectance.z, 0.75, 1e-3);  // of the upper hemisphere
}

TEST(Shaders, AreAssignedByMaterialOrNodeAndTheLastMatchWins) {
  Square square;
  square.gltf.node({{"name", "other"}, {"mesh", 0}, {"translation", {5, 0, 0}}});
  square.job.shaders = {reflecting("w?ll", {"0.1", "0.1", "0.1"}), reflecting("oth*", {"0.2", "0.2", "0.2"}),
                        reflecting("absent", {"0", "0", "0"})};
  const PatchSet scene = square.import(square.gltf);
  ASSERT_EQ(scene.primitives.size(), 2u);
  EXPECT_EQ(scene.shaders.size(), 2u);
  EXPECT_EQ(scene.shaders[scene.primitives[0].shader].name, "w?ll");
  EXPECT_EQ(scene.shaders[scene.primitives[1].shader].name, "oth*");
  EXPECT_NEAR(scene.patches.front().reflectance.x, 0.1, 1e-6);
  EXPECT_NEAR(scene.patches.back().reflectance.x, 0.2, 1e-6);
  EXPECT_THAT(square.messages(), ::testing::HasSubstr("shaders.absent in the job matches no material"));
}

TEST(Shaders, EmissionCreatesALightGroup) {
  Square square;
  const PatchSet scene = square.shaded(emitting("wall", "4*u"));
  EXPECT_EQ(scene.light_groups, std::vector<std::string>{"wall"});
  for (const Patch& patch : scene.patches) {
    EXPECT_NEAR(patch.emission.x, 2 * (patch.u0 + patch.u1), 1e-4);
    EXPECT_EQ(patch.emission.y, 1.0f);
    EXPECT_NEAR(patch.reflectance.x, 0.99999, 1e-6);  // the material's
  }
}

TEST(Shaders, FaultsPointIntoTheExpression) {
  Square square;
  EXPECT_ERROR(square.shaded(reflecting("wall", {"u", "1+*u", "1"})), ExitCode::bad_config,
               "bad expression `1+*u` at character 3 (job.yaml, shaders.wall.reflectance): Unexpected operator \"*\"");
  EXPECT_ERROR(square.shaded(emitting("nowhere", "w")), ExitCode::bad_config, "shaders.nowhere.emission");
}

TEST(Shaders, ValuesOutOfRangeAreRefusedWithTheirPosition) {
  Square square;
  EXPECT_ERROR(square.shaded(reflecting("wall", {"1", "u - 0.5", "1"})), ExitCode::bad_config,
               "job.yaml, shaders.wall.reflectance");
  EXPECT_ERROR(square.shaded(reflecting("wall", {"1", "1", "0*log(v-1)"})), ExitCode::bad_config, "nan in blue at u ");
  EXPECT_ERROR(square.shaded(emitting("wall", "1/(u-u)")), ExitCode::bad_config, "emission is inf in red");
  EXPECT_NO_THROW(square.shaded(reflecting("wall", {"u*1e-9 - 1e-9", "0", "0"})));  // rounding
}

TEST(Shaders, TooMuchReflectanceIsLoweredWithOneWarning) {
  Square square;
  const PatchSet scene = square.shaded(reflecting("wall", {"2", "1", "0.5"}));
  EXPECT_EQ(scene.patches[0].reflectance, Color(0.99999f, 0.99999f, 0.5f));
  const std::string messages = square.messages();
  const std::string warning = "shader 'wall' is lowered";
  ASSERT_NE(messages.find(warning), std::string::npos);
  EXPECT_EQ(messages.find(warning), messages.rfind(warning));
}

TEST(Shaders, ReflectanceIsLimitedByTheMetallicPart) {
  Square square(
      {{"name", "wall"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.8, 0.4, 0.8, 1}}, {"metallicFactor", 0.5}}}});
  const PatchSet scene = square.shaded(reflecting("wall", {"0.9", "0.7", "0.3"}));
  EXPECT_NEAR(scene.patches[0].reflectance.x, 0.6, 1e-6);
  EXPECT_NEAR(scene.patches[0].reflectance.y, 0.7, 1e-6);
  EXPECT_NEAR(scene.patches[0].reflectance.z, 0.3, 1e-6);
}

TEST(Shaders, UseTextureCoordinatesOfTheQuad) {
  Square square;
  square.texcoords({0, 3, 0, 5, 2, 3, 2, 5});  // u = 2 y, v = 3 + 2 x
  const PatchSet scene = square.shaded(reflecting("wall", {"u/4", "v/10", "0"}));
  ASSERT_EQ(scene.primitives.size(), 1u);
  ASSERT_EQ(scene.texcoords.size(), 1u);
  for (const Patch& patch : scene.patches) {
    EXPECT_NEAR(patch.reflectance.x, patch.center.y / 2, 1e-5);
    EXPECT_NEAR(patch.reflectance.y, 0.3 + patch.center.x / 5, 1e-5);
  }
}

TEST(Shaders, BothSidesUseTheSameTextureCoordinates) {
  Json material = kWall;
  material["doubleSided"] = true;
  Square square(material);
  square.texcoords({0, 0, 0.5f, 0, 0, 1, 0.5f, 1});  // u = x / 2
  const PatchSet scene = square.shaded(reflecting("wall", {"u", "u", "u"}));
  ASSERT_EQ(scene.texcoords.size(), 2u);
  for (const Patch& patch : scene.patches) EXPECT_NEAR(patch.reflectance.x, patch.center.x / 2, 1e-5);
}

TEST(Shaders, TrianglesWithDifferentMappingsAreMergedOnlyIfUvIsUnused) {
  Square square;
  square.texcoords({0, 0, 1, 0, 0, 1, 0.5f, 1});  // bent along the diagonal
  const PatchSet bent = square.shaded(reflecting("wall", {"u", "0", "0"}));
  ASSERT_EQ(bent.primitives.size(), 2u);
  double mean_u = 0;
  for (const Patch& patch : bent.patches) mean_u += patch.reflectance.x * patch.area;
  EXPECT_NEAR(mean_u, (0 + 1 + 0.5) / 6 + (0 + 0.5 + 0) / 6, 1e-4);

  const PatchSet plain = square.shaded(reflecting("wall", {"x", "0", "0"}));
  EXPECT_EQ(plain.primitives.size(), 1u);
  EXPECT_TRUE(plain.texcoords.empty());
  EXPECT_EQ(square.shaded(reflecting("absent", {"u", "0", "0"})).primitives.size(), 1u);
}

TEST(Shaders, SurfacesWithoutTextureCoordinatesUseTheirOwnUv) {
  Square square;
  square.texcoords({0, 0, 0, 0, 0, 0, 0, 0});
  square.gltf.node({{"name", "bare"}, {"mesh", square.gltf.mesh(grid(1), 0)}, {"translation", {5, 0, 0}}});
  const PatchSet scene = square.shaded(reflecting("wall", {"u", "v", "0"}));
  ASSERT_EQ(scene.texcoords.size(), 2u);
  EXPECT_EQ(scene.texcoords[1], kIdentityTexcoords);
  EXPECT_NEAR(scene.patches.back().reflectance.x, 0.875, 1e-5);
}

TEST(Shaders, TextureCoordinatesMayBeNormalizedIntegers) {
  Square square;
  const std::vector<std::uint16_t> uv{0, 0, 65535, 0, 0, 13107, 65535, 13107};  // v = y / 5
  square.gltf.primitive(0)["attributes"]["TEXCOORD_0"] = square.gltf.accessor(uv, 5123, "VEC2");
  square.gltf.json["accessors"].back().update({{"count", 4}, {"normalized", true}});
  for (const Patch& patch : square.shaded(reflecting("wall", {"u", "v", "0"})).patches)
    EXPECT_NEAR(patch.reflectance.y, patch.center.y / 5, 1e-5);
}

TEST(Shaders, BadTextureCoordinatesAreRefusedOnlyIfUsed) {
  const Shader reads = reflecting("wall", {"u", "v", "0"}), ignores = reflecting("wall", {"x", "0", "0"});
  Square few, infinite, whole;
  few.texcoords({0, 0, 1, 1});
  infinite.texcoords({0, 0, INFINITY, 0, 0, 1, 1, 1});
  whole.gltf.primitive(0)["attributes"]["TEXCOORD_0"] = 99;
  for (Square* square : {&few, &infinite, &whole}) {
    EXPECT_NO_THROW(square->shaded(ignores));
    EXPECT_ERROR(square->shaded(reads), ExitCode::bad_data, "scene.glb");
  }
}

}  // namespace
}  // namespace patchlight::test
