// Scenes that are difficult to import, run through patchlight-import.
#include <gmock/gmock.h>

#include <limits>

#include "pipeline/formats/patches/patch_file.h"
#include "tests/end_to_end/hard_cases/hard_cases.h"
#include "tests/end_to_end/program.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

Json diffuse(const char* name, double reflectance, double exitance) {
  const double radiance = exitance / kPi;
  return {{"name", name},
          {"emissiveFactor", {radiance, radiance, radiance}},
          {"pbrMetallicRoughness",
           {{"metallicFactor", 0}, {"baseColorFactor", {reflectance, reflectance, reflectance, 1}}}}};
}

Outcome import_in(const TemporaryFolder& folder, GltfBuilder gltf, const std::string& settings = "") {
  folder.write("scene.glb", gltf.glb());
  folder.write("job.yaml", "scene: scene.glb\noutput: out\n" + settings);
  return run_program(folder, "patchlight-import", {"job.yaml"});
}

Mesh joined(const std::vector<std::array<Vec3f, 4>>& quads) {
  Mesh mesh;
  for (const auto& corners : quads) {
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + k);
  }
  return mesh;
}

/// The faces of a cube from -1 to 1 without its floor, facing inwards.
std::vector<std::array<Vec3f, 4>> walls_and_ceiling() {
  return {{{{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}},
          {{{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}},
          {{{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}},
          {{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}},
          {{{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}}};
}

TEST_F(HardCases, PatchAreaLargerThanThePrimitive) {
  GltfBuilder gltf;
  const int hot = gltf.mesh(joined({{{{-1, -1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, -1, -1}}}}),
                            gltf.material(diffuse("hot", 0.5, 1)));
  gltf.node({{"mesh", hot}});
  gltf.node({{"mesh", gltf.mesh(joined(walls_and_ceiling()), gltf.material(diffuse("cold", 0.5, 0)))}});
  const TemporaryFolder folder;
  ASSERT_EQ(import_in(folder, gltf, "import: {patch_area: 100}\n").code, 0);
  const PatchSet scene = read_patches(folder / "out/patches.h5");
  ASSERT_EQ(scene.patches.size(), 6u);
  SolveConfig config = hard_case_config();
  config.rays = 1 << 16;
  const auto exact = [](const Patch& patch) {  // one patch a face
    if (patch.normal.y > 0.5f) return 2 * 0.090909098;
    return patch.normal.y < -0.5f ? 2 * 0.181745826 : 2 * 0.181836269;
  };
  // Six patches shoot by few hemicubes, each from one point of its patch.
  expect_exact("patches as large as their walls", scene, exact, {1e-3, 0.02, 5e-3, 0.1}, config);
}

TEST_F(HardCases, TVertices) {
  const float x = -1.0f / 3, z = 1.0f / 7;
  std::vector<std::array<Vec3f, 4>> quads = walls_and_ceiling();
  quads.push_back({{{-1, -1, -1}, {-1, -1, 1}, {x, -1, 1}, {x, -1, -1}}});
  quads.push_back({{{x, -1, -1}, {x, -1, z}, {1, -1, z}, {1, -1, -1}}});
  quads.push_back({{{x, -1, z}, {x, -1, 1}, {1, -1, 1}, {1, -1, z}}});
  GltfBuilder gltf;
  // Rotated and moved, so that T-vertices deviate from the edges they lie on by rounding.
  gltf.node({{"mesh", gltf.mesh(joined(quads), gltf.material(diffuse("walls", 0.9, 1)))},
             {"rotation", {0.18, 0.36, 0.54, 0.7391887}},
             {"translation", {0.1, 0.7, -0.3}}});
  const TemporaryFolder folder;
  ASSERT_EQ(import_in(folder, gltf, "import: {patch_area: 0.1}\n").code, 0);
  expect_exact("furnace with T-vertices", read_patches(folder / "out/patches.h5"),
               [](const Patch&) { return 1 / (1 - 0.9f); }, {1e-3, 1e-3, 0.02, 0.15});
}

TEST_F(HardCases, ZeroAreaFaces) {
  Mesh mesh = inverted(cube());
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 2, 2, 2, 3, 4, 3});
  GltfBuilder gltf;
  gltf.node({{"mesh", gltf.mesh(mesh, gltf.material(diffuse("walls", 0.5, 1)))}});
  const TemporaryFolder folder;
  const Outcome outcome = import_in(folder, gltf, "import: {patch_area: 0.1}\n");
  ASSERT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("3 triangles without area are skipped"));
  expect_exact("furnace with faces of no area, skipped with a warning", read_patches(folder / "out/patches.h5"),
               [](const Patch&) { return 2.0; }, {1e-3, 1e-3, 0.05, 0.15});
}

TEST_F(HardCases, ReflectanceOne) {
  GltfBuilder gltf;
  gltf.node({{"mesh", gltf.mesh(inverted(cube()), gltf.material(diffuse("snow", 1, 1)))}});
  const TemporaryFolder folder;
  const Outcome outcome = import_in(folder, gltf, "import: {patch_area: 0.25}\n");
  ASSERT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("'snow' is lowered to 0.99999"));
  expect_exact("furnace, reflectance 1, lowered to 0.99999 with a warning", read_patches(folder / "out/patches.h5"),
               [](const Patch&) { return 1 / (1 - 0.99999f); }, {1e-3, 5e-3, 0.02, 0.6});
}

TEST_F(HardCases, InvalidNumbers) {
  const auto refused = [](const std::string& name, const Mesh& mesh, const Json& material, const std::string& named) {
    GltfBuilder gltf;
    gltf.node({{"mesh", gltf.mesh(mesh, gltf.material(material))}, {"name", "crate"}});
    const TemporaryFolder folder;
    const Outcome outcome = import_in(folder, gltf);
    EXPECT_EQ(outcome.code, 65) << name;
    EXPECT_THAT(outcome.err, HasSubstr(named)) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/patches.h5")) << name;
    const std::string cell = outcome.code == 65 ? "refused, naming `" + named + "`" : "not refused";
    print_row(name, {cell, cell, cell, cell});
  };
  Mesh damaged = cube();
  damaged.positions[3].y = std::numeric_limits<float>::quiet_NaN();
  refused("NaN in a position", damaged, diffuse("paint", 0.5, 1), "crate");
  refused("negative emission", cube(), diffuse("paint", 0.5, -1), "paint");
  refused("negative reflectance", cube(), diffuse("paint", -0.5, 1), "paint");
}

}  // namespace
}  // namespace patchlight::test
