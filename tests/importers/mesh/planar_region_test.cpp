#include "importers/mesh/planar_region.h"

#include <gtest/gtest.h>

#include "tests/importers/gltf_builder.h"
#include "tests/importers/mesh/mesh_shapes.h"

namespace patchlight::test {
namespace {

const double kHoleArea = 0.5 * 16 * std::sin(2 * kPi / 16) * 0.25;  // of 16 corners 0.5 from the middle

const Json kPaint = {{"name", "paint"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}};

/// The only primitive with a region, or null.
const Primitive* region_of(const PatchSet& scene) {
  const Primitive* found = nullptr;
  for (const Primitive& p : scene.primitives)
    if (p.region) found = found ? nullptr : &p;
  return found;
}

TEST(PlanarRegion, PlateWithAHoleIsOnePrimitive) {
  GltfBuilder gltf = single_mesh(plate_with_hole(2, 0.5), kPaint);
  const PatchSet scene = Importer().import(gltf);
  ASSERT_EQ(scene.primitives.size(), 1u);
  const Primitive* plate = region_of(scene);
  ASSERT_NE(plate, nullptr);
  EXPECT_NEAR(plate->region->area(), 1 - kHoleArea / 4, 1e-7) << "over the square";
  EXPECT_EQ(plate->region->edges.size(), 20u) << "vertices in the middle of straight edges are left out";
  EXPECT_NEAR(facing(*plate).z, 1, 1e-12);
  EXPECT_NEAR(total_area(scene), 4 - kHoleArea, 1e-6);
}

TEST(PlanarRegion, OfATurnedMeshRunsAlongItsEdges) {
  GltfBuilder gltf =
      single_mesh(plate_with_hole(2, 0.5), kPaint, {{"rotation", {0, 0, 0.258819, 0.9659258}}});  // by 30 degrees
  const PatchSet scene = Importer().import(gltf);
  ASSERT_NE(region_of(scene), nullptr);
  const auto& c = region_of(scene)->corners;
  EXPECT_NEAR((c[1] - c[0]).length(), 2, 1e-5);
  EXPECT_NEAR((c[3] - c[0]).length(), 2, 1e-5);
}

TEST(PlanarRegion, HasPatchesOnlyWhereItIs) {
  GltfBuilder gltf = single_mesh(plate_with_hole(2, 0.9), kPaint);
  Importer importer;
  importer.job.import.patch_area = 0.01;
  const PatchSet scene = importer.import(gltf);
  ASSERT_NE(region_of(scene), nullptr);
  EXPECT_LT(scene.patches.size(), 300u) << "of 400 cells";
  for (const Patch& patch : scene.patches) {
    EXPECT_GT(std::hypot(patch.center.x, patch.center.y), 0.88) << "centres lie on the surface";
    EXPECT_LE(patch.area, 0.01 + 1e-7);
  }
  EXPECT_NEAR(total_area(scene), 4 - kHoleArea * 0.81 / 0.25, 1e-4);
}

TEST(PlanarRegion, WhoseOutlineTouchesItselfIsOne) {
  Mesh mesh = grid(4);  // two triangles of the grid's interior are missing that touch in one vertex
  std::vector<std::uint32_t> kept;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t)
    if (t != 2 * 5 && t != 2 * 10)
      kept.insert(kept.end(), mesh.indices.begin() + std::ptrdiff_t(3 * t),
                  mesh.indices.begin() + std::ptrdiff_t(3 * t + 3));
  mesh.indices = kept;
  GltfBuilder gltf = single_mesh(mesh, kPaint);
  const PatchSet scene = Importer().import(gltf);
  ASSERT_EQ(scene.primitives.size(), 1u);
  EXPECT_NEAR(total_area(scene), 15, 1e-9);
}

TEST(PlanarRegion, TextureCoordinatesContinueTheMesh) {
  Mesh mesh = plate_with_hole(2, 0.5);
  GltfBuilder gltf = single_mesh(mesh, kPaint);
  std::vector<Vec2f> texcoords;
  for (const Vec3f& p : mesh.positions) texcoords.emplace_back(3 + p.x - 2 * p.y, 1 + p.y);
  gltf.primitive(0)["attributes"]["TEXCOORD_0"] = gltf.accessor(texcoords, 5126, "VEC2");
  Importer importer;
  importer.job.shaders = {{"*", {"u / 9", "v / 9", "0"}, {}}};
  const PatchSet scene = importer.import(gltf);
  ASSERT_NE(region_of(scene), nullptr);
  ASSERT_EQ(scene.texcoords.size(), 1u);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3d& corner = region_of(scene)->corners[k];
    EXPECT_NEAR(scene.texcoords[0][k].x, 3 + corner.x - 2 * corner.y, 1e-5);
    EXPECT_NEAR(scene.texcoords[0][k].y, 1 + corner.y, 1e-5);
  }
}

TEST(PlanarRegion, SidesOfADoubleSidedOneMirrorEachOther) {
  GltfBuilder gltf =
      single_mesh(plate_with_hole(2, 0.5), {{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  const PatchSet scene = Importer().import(gltf);
  ASSERT_EQ(scene.primitives.size(), 2u);
  const Primitive &front = scene.primitives[0], &back = scene.primitives[1];
  ASSERT_TRUE(front.region && back.region);
  EXPECT_EQ(front.back, 1);
  EXPECT_NEAR(facing(back).z, -1, 1e-12);
  EXPECT_EQ(*back.region, front.region->mirrored());
  for (std::size_t k = 0; k < front.region->edges.size(); ++k) {
    const auto& [from, to] = front.region->edges[k];
    const auto& [back_from, back_to] = back.region->edges[k];
    EXPECT_LT((position_at(front.corners, from.x, from.y) - position_at(back.corners, back_to.x, back_to.y)).length(),
              1e-9);
    EXPECT_LT((position_at(front.corners, to.x, to.y) - position_at(back.corners, back_from.x, back_from.y)).length(),
              1e-9);
  }
}

TEST(PlanarRegion, LampsAndMirrorsAreNone) {
  for (const Json& material : {Json{{"emissiveFactor", {1, 1, 1}}},
                               Json{{"pbrMetallicRoughness", {{"metallicFactor", 1}, {"roughnessFactor", 0}}}}}) {
    GltfBuilder gltf = single_mesh(plate_with_hole(2, 0.5), material);
    const PatchSet scene = Importer().import(gltf);
    EXPECT_EQ(region_of(scene), nullptr);
    EXPECT_GT(scene.primitives.size(), 1u);
  }
}

}  // namespace
}  // namespace patchlight::test
