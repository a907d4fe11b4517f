#include <gtest/gtest.h>

#include "tests/expect_error.h"
#include "tests/importers/gltf_packer.h"

namespace patchlight::test {
namespace {

/// Expects equal primitives at equal positions.
void expect_same(const PatchSet& scene, const PatchSet& plain, double tolerance = 1e-6) {
  ASSERT_EQ(scene.primitives.size(), plain.primitives.size());
  for (std::size_t i = 0; i < scene.primitives.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_LE((scene.primitives[i].corners[k] - plain.primitives[i].corners[k]).length(), tolerance);
  EXPECT_NEAR(total_area(scene), total_area(plain), 10 * tolerance);
}

/// To be called before a test creates its own Importer: these share a folder.
PatchSet plain_cube() {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  return importer.import(gltf);
}

TEST(CompressedMeshes, SparseElementsReplaceElements) {
  const PatchSet plain = plain_cube();
  Importer importer;
  Mesh modified = cube();
  modified.positions[3] = Vec3f(5, 5, 5);
  modified.positions[7] = Vec3f(0, 0, 0);
  GltfBuilder gltf = single_mesh(modified);
  const std::vector<std::uint16_t> replaced{3, 7};
  const int indices = gltf.accessor(replaced, 5123, "SCALAR");
  const int values = gltf.accessor(std::vector{cube().positions[3], cube().positions[7]}, 5126, "VEC3");
  gltf.json["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", gltf.json["accessors"][indices]["bufferView"]}, {"componentType", 5123}}},
      {"values", {{"bufferView", gltf.json["accessors"][values]["bufferView"]}}}};
  expect_same(importer.import(gltf), plain);

  gltf.json["accessors"][0]["sparse"]["count"] = 3;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "reach beyond bufferViews");
  gltf.json["accessors"][0]["sparse"]["count"] = 9;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "9 of 8 elements");
  gltf.json["accessors"][0]["sparse"]["count"] = 2;
  gltf.binary[gltf.json["bufferViews"][2]["byteOffset"].get<std::size_t>()] = 8;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "sparse element 8 of 8 does not exist");
}

TEST(CompressedMeshes, SparseAccessorWithoutBufferViewStartsFromZeros) {
  Importer importer;
  GltfBuilder gltf = single_mesh(quad_mesh({Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(1, 1, 0), Vec3f(0, 1, 0)}));
  const int indices = gltf.accessor(std::vector<std::uint8_t>{1, 2, 3}, 5121, "SCALAR");
  const int values = gltf.accessor(std::vector{Vec3f(1, 0, 0), Vec3f(1, 1, 0), Vec3f(0, 1, 0)}, 5126, "VEC3");
  Json& accessor = gltf.json["accessors"][0];
  accessor["sparse"] = {
      {"count", 3},
      {"indices", {{"bufferView", gltf.json["accessors"][indices]["bufferView"]}, {"componentType", 5121}}},
      {"values", {{"bufferView", gltf.json["accessors"][values]["bufferView"]}}}};
  accessor.erase("bufferView");
  EXPECT_NEAR(total_area(importer.import(gltf)), 1.0, 1e-9);
  accessor["count"] = std::int64_t{1} << 40;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "accessors[0]");
}

TEST(CompressedMeshes, QuantizedAndInterleavedPositionsAreRead) {
  const PatchSet plain = plain_cube();
  for (const bool normalized : {false, true}) {
    Importer importer;
    GltfBuilder gltf;
    std::vector<std::int8_t> values;  // three per vertex and one of padding
    for (const Vec3f& p : cube().positions)
      for (int i = 0; i < 4; ++i) values.push_back(std::int8_t(i == 3 ? 77 : int(p[i]) * (normalized ? 127 : 1)));
    gltf.node({{"mesh", gltf.mesh(cube())}});
    Json view = appended(gltf, values.data(), values.size());
    view["byteStride"] = 4;
    gltf.json["accessors"][0] = {{"bufferView", add(gltf.json["bufferViews"], view)},
                                 {"componentType", 5120},
                                 {"normalized", normalized},
                                 {"count", 8},
                                 {"type", "VEC3"}};
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "POSITION must be VEC3 of 32-bit floats");
    gltf.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    expect_same(importer.import(gltf), plain);
  }
}

TEST(CompressedMeshes, MeshoptGivesTheSameScene) {
  const PatchSet plain = plain_cube();
  Importer importer;
  GltfBuilder gltf;
  const QuantizedPositions positions(cube());
  gltf.node(positions.with_transform({{"mesh", quantized_mesh(gltf, cube(), positions, true)}}));
  expect_same(importer.import(gltf), plain);

  Json& packed = gltf.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  const Json intact = packed;
  const auto expect_refused = [&](const char* key, const Json& value, const char* text) {
    packed[key] = value;
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, text);
    packed = intact;
  };
  expect_refused("count", std::int64_t{1} << 50, "do not match");
  expect_refused("byteStride", 6, "byteStride or count");
  expect_refused("byteLength", 1 << 20, "reaches beyond its buffer");
  expect_refused("buffer", 9, "index 9");
  expect_refused("buffer", 1, "has no data");
  expect_refused("mode", "STRIPS", "unknown mode 'STRIPS'");
  expect_refused("filter", "OCTAHEDRON", "unknown filter 'OCTAHEDRON'");
  gltf.binary[packed["byteOffset"].get<std::size_t>()] = 0;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "bufferViews[0]");
}

TEST(CompressedMeshes, DracoGivesTheSameScene) {
  Importer importer;
  GltfBuilder gltf;
  gltf.node({{"mesh", draco_mesh(gltf, cube(), 0)}});
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.primitives.size(), 6u);
  EXPECT_NEAR(total_area(scene), 24.0, 1e-5);

  const auto expect_refused = [&](const char* text, const auto& modify) {
    GltfBuilder copy = gltf;
    modify(copy);
    EXPECT_ERROR(importer.import(copy), ExitCode::bad_data, text);
  };
  expect_refused("12 triangles in", [](GltfBuilder& g) { g.json["accessors"][1]["count"] = 39; });
  expect_refused("8 vertices, but the accessor has 7", [](GltfBuilder& g) { g.json["accessors"][0]["count"] = 7; });
  const auto extension = [](GltfBuilder& g) -> Json& {
    return g.primitive(0)["extensions"]["KHR_draco_mesh_compression"];
  };
  expect_refused("no POSITION", [&](GltfBuilder& g) { extension(g)["attributes"]["POSITION"] = 5; });
  expect_refused("no bufferView", [&](GltfBuilder& g) { extension(g).erase("bufferView"); });
  expect_refused("index 7", [&](GltfBuilder& g) { extension(g)["bufferView"] = 7; });
  expect_refused("damaged header", [](GltfBuilder& g) { g.binary[0] = 'X'; });
  expect_refused("not 2.2", [](GltfBuilder& g) { g.binary[6] = 1; });
  expect_refused("damaged", [](GltfBuilder& g) { g.json["bufferViews"][0]["byteLength"] = 30; });
}

TEST(CompressedMeshes, CompressedBytesReusedManyTimesAreRefused) {
  for (const bool draco : {false, true}) {
    Importer importer;
    GltfBuilder gltf;
    Mesh mesh_to_encode = grid(100);
    for (Vec3f& p : mesh_to_encode.positions) {
      if (!draco && p.x + p.y > 0.0f) p = Vec3f(1.0f);  // which compresses well
    }
    const QuantizedPositions positions(mesh_to_encode);
    const int mesh =
        draco ? draco_mesh(gltf, mesh_to_encode, 11) : quantized_mesh(gltf, mesh_to_encode, positions, true);
    gltf.node(positions.with_transform({{"mesh", mesh}}));
    for (int i = 0; i < 200; ++i) {
      gltf.json["bufferViews"].push_back(gltf.json["bufferViews"][0]);
      gltf.json["meshes"].push_back(gltf.json["meshes"][0]);
    }
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "more than the buffers can contain");
  }
}

TEST(CompressedMeshes, DamagedCompressedBytesAreRefusedOrGiveNoExtraPrimitives) {
  for (const bool draco : {false, true}) {
    Importer importer;
    GltfBuilder gltf;
    const Mesh sphere = uv_sphere(16, 8);
    const QuantizedPositions positions(sphere);
    const int mesh = draco ? draco_mesh(gltf, sphere, 11) : quantized_mesh(gltf, sphere, positions, true);
    gltf.node(positions.with_transform({{"mesh", mesh}}));
    const std::string intact = gltf.binary;
    std::uint32_t random = 1;
    for (int i = 0; i < 100; ++i) {
      gltf.binary = intact;
      for (int k = 0; k < 3; ++k) {
        random = random * 1664525u + 1013904223u;
        gltf.binary[(random >> 8) % intact.size()] = char(random >> 24);
      }
      try {
        EXPECT_LE(importer.import(gltf).primitives.size(), sphere.indices.size() / 3);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::bad_data);
      }
    }
  }
}

}  // namespace
}  // namespace patchlight::test
