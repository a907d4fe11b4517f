// A scene imports as the same primitives whichever glTF encoding stores it.
#include <gtest/gtest.h>

#include "tests/importers/gltf_packer.h"

namespace patchlight::test {
namespace {

struct Summary {
  int quads = 0, triangles = 0, spheres = 0;
  double area = 0.0;  ///< m2
  double radius = 0.0;
};

Summary summary_of(const PatchSet& scene) {
  Summary result;
  for (const Primitive& p : scene.primitives) {
    const bool sphere = p.shape == Primitive::Shape::sphere;
    ++(sphere ? result.spheres : p.is_triangle() ? result.triangles : result.quads);
    if (sphere) result.radius = p.sphere_radius;
  }
  result.area = total_area(scene);
  return result;
}

Mesh moved(Mesh mesh, const Vec3f& offset) {
  for (Vec3f& p : mesh.positions) p += offset;
  return mesh;
}

Mesh joined(const std::vector<Mesh>& meshes) {
  Mesh all;
  for (const Mesh& mesh : meshes) {
    const auto first = std::uint32_t(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const std::uint32_t index : mesh.indices) all.indices.push_back(first + index);
  }
  return all;
}

/// A floor of 10 x 10 faces, two boxes and a sphere.
const Mesh kFloor = scaled(grid(10), Vec3f(0.8f));
const Vec3f kBoxes[] = {Vec3f(2, 3, 1.5f), Vec3f(6, 5, 1.5f)};
const Vec3f kSphere(6, 2, 3);

/// Imports the scene; `add_mesh(gltf, mesh)` adds a mesh and returns the JSON of its node.
template <class AddMesh>
Summary imported(const AddMesh& add_mesh) {
  Importer importer;
  GltfBuilder gltf;
  gltf.node(add_mesh(gltf, kFloor));
  for (const Vec3f& position : kBoxes) gltf.node(add_mesh(gltf, moved(cube(), position)));
  gltf.node(add_mesh(gltf, moved(uv_sphere(32, 16), kSphere)));
  return summary_of(importer.import(gltf));
}

void expect_same(const Summary& actual, double precision) {
  EXPECT_EQ(actual.quads, 1 + 6 + 6);
  EXPECT_EQ(actual.triangles, 0);
  EXPECT_EQ(actual.spheres, 1);
  EXPECT_NEAR(actual.radius, 1.0, precision);
  EXPECT_NEAR(actual.area, 64 + 2 * 24 + 4 * kPi, 64 * precision);
}

TEST(SameScene, Plain) {
  expect_same(imported([](GltfBuilder& gltf, const Mesh& mesh) { return Json{{"mesh", gltf.mesh(mesh)}}; }), 1e-6);
}

TEST(SameScene, Quantized) {
  for (const bool meshopt : {false, true}) {
    const auto add = [&](GltfBuilder& gltf, const Mesh& mesh) {
      const QuantizedPositions positions(mesh);
      return positions.with_transform({{"mesh", quantized_mesh(gltf, mesh, positions, meshopt)}});
    };
    expect_same(imported(add), 1e-3);
  }
}

TEST(SameScene, Draco) {
  for (const int bits : {0, 14}) {
    const auto add = [&](GltfBuilder& gltf, const Mesh& mesh) { return Json{{"mesh", draco_mesh(gltf, mesh, bits)}}; };
    expect_same(imported(add), bits == 0 ? 1e-6 : 1e-3);
  }
}

TEST(SameScene, Merged) {
  Importer importer;
  GltfBuilder gltf = single_mesh(
      joined({kFloor, moved(cube(), kBoxes[0]), moved(cube(), kBoxes[1]), moved(uv_sphere(32, 16), kSphere)}));
  expect_same(summary_of(importer.import(gltf)), 1e-6);
}

TEST(SameScene, Instanced) {
  Importer importer;
  GltfBuilder gltf;
  gltf.node({{"mesh", gltf.mesh(kFloor)}});
  gltf.node({{"mesh", gltf.mesh(uv_sphere(32, 16))}, {"translation", {kSphere.x, kSphere.y, kSphere.z}}});
  const int positions = gltf.accessor(std::vector<Vec3f>{kBoxes[0], kBoxes[1]}, 5126, "VEC3");
  gltf.node({{"mesh", gltf.mesh(cube())},
             {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", positions}}}}}}}});
  expect_same(summary_of(importer.import(gltf)), 1e-6);
}

}  // namespace
}  // namespace patchlight::test
