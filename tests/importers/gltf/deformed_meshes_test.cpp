#include <ImathBox.h>
#include <gtest/gtest.h>

#include <optional>

#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

Vec3d mean_corner(const PatchSet& scene) {
  Vec3d sum(0.0);
  for (const Primitive& p : scene.primitives)
    for (const Vec3d& corner : p.corners) sum += corner / (4.0 * double(scene.primitives.size()));
  return sum;
}

TEST(DeformedMeshes, InstancesAreImportedLikeNodes) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube(), nullptr, {{"name", "box"}, {"scale", {2, 2, 2}}});
  const auto instancing = [&](const char* key, int accessor) {
    gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][key] = accessor;
  };
  instancing("TRANSLATION", gltf.accessor(std::vector<Vec3f>{{0, 0, 0}, {5, 0, 0}}, 5126, "VEC3"));
  instancing("SCALE", gltf.accessor(std::vector<Vec3f>{{1, 1, 1}, {1, 2, 3}}, 5126, "VEC3"));
  // A quarter turn about Z, as normalized shorts.
  instancing("ROTATION", gltf.accessor(std::vector<std::array<std::int16_t, 4>>{{0, 0, 0, 32767}, {0, 0, 23170, 23170}},
                                       5122, "VEC4"));
  gltf.json["accessors"].back()["normalized"] = true;
  gltf.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 12u);
  Imath::Box<Vec3d> box;
  for (std::size_t i = 6; i < 12; ++i) {
    EXPECT_EQ(scene.primitives[i].node, 0);
    for (const Vec3d& corner : scene.primitives[i].corners) box.extendBy(corner);
  }
  EXPECT_LE((box.min - Vec3d(6, -2, -6)).length(), 1e-3);
  EXPECT_LE((box.max - Vec3d(14, 2, 6)).length(), 1e-3);

  gltf.json["accessors"][2]["count"] = 1;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "instance attributes of unequal counts");
  gltf.json["accessors"][2]["count"] = 2;
  gltf.json["accessors"][2].erase("bufferView");
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "which has no bufferView");
}

TEST(DeformedMeshes, SkinsTakeThePoseOfTheirJoints) {
  Importer importer;
  GltfBuilder gltf =
      single_mesh(cube(), nullptr, {{"translation", {100, 0, 0}}, {"skin", 0}});  // the node's own transform is ignored
  gltf.node({{"translation", {3, 0, 0}}, {"children", {2}}});
  gltf.json["nodes"].push_back({{"translation", {0, 4, 0}}, {"scale", {-1, 1, 1}}});
  std::vector<std::array<std::uint8_t, 4>> joints(8, {0, 1, 9, 9});
  std::vector<std::array<float, 4>> weights(8, {0, 2, 0, 0});  // not normalized
  gltf.primitive(0)["attributes"]["JOINTS_0"] = gltf.accessor(joints, 5121, "VEC4");
  gltf.primitive(0)["attributes"]["WEIGHTS_0"] = gltf.accessor(weights, 5126, "VEC4");
  Imath::M44f moved_back;
  moved_back.setTranslation(Vec3f(0, 0, -7));
  gltf.json["skins"] = {
      {{"joints", {1, 2}}, {"inverseBindMatrices", gltf.accessor(std::vector{moved_back, moved_back}, 5126, "MAT4")}}};
  const PatchSet scene = importer.import(gltf);
  ASSERT_EQ(scene.primitives.size(), 6u);
  EXPECT_LE((mean_corner(scene) - Vec3d(3, 4, -7)).length(), 1e-6);
  for (const Primitive& p : scene.primitives)
    EXPECT_GT(facing(p).dot((p.corners[0] + p.corners[2]) * 0.5 - Vec3d(3, 4, -7)), 0.0) << "inside out";

  gltf.json["skins"][0]["joints"] = {1};
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "refers to joint 1, but the skin has 1 joints");
  gltf.json["skins"][0]["joints"] = {1, 2, 0};
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "2 matrices for 3 joints");
}

TEST(DeformedMeshes, MorphTargetsUseTheFilesWeights) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  gltf.primitive(0)["targets"] = {{{"POSITION", gltf.accessor(std::vector<Vec3f>(8, {1, 0, 0}), 5126, "VEC3")}},
                                  {{"POSITION", gltf.accessor(std::vector<Vec3f>(8, {0, 1, 0}), 5126, "VEC3")}}};
  EXPECT_LE(mean_corner(importer.import(gltf)).length(), 1e-6);
  gltf.json["meshes"][0]["weights"] = {0.5, 2};
  EXPECT_LE((mean_corner(importer.import(gltf)) - Vec3d(0.5, 2, 0)).length(), 1e-6);
  gltf.json["nodes"][0]["weights"] = {0, 1};
  EXPECT_LE((mean_corner(importer.import(gltf)) - Vec3d(0, 1, 0)).length(), 1e-6);
  gltf.json["accessors"].back()["count"] = 7;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "morph target with another number");
}

TEST(DeformedMeshes, NodesFollowAnimationsAtImportTime) {
  const float turn = float(std::sqrt(0.5));
  const auto position_at = [&](const char* path, const char* type, const std::vector<float>& values,
                               const char* interpolation, std::optional<double> time) {
    Importer importer;
    importer.job.import.time = time;
    GltfBuilder gltf = single_mesh(cube(), nullptr, {{"children", {1}}});
    gltf.json["nodes"][0].erase("mesh");
    gltf.json["nodes"].push_back({{"mesh", 0}, {"translation", {8, 0, 0}}});
    gltf.primitive(0)["targets"] = {{{"POSITION", gltf.accessor(std::vector<Vec3f>(8, {0, 0, 1}), 5126, "VEC3")}}};
    const int times = gltf.accessor(std::vector<float>{1, 3, 4}, 5126, "SCALAR");
    const int output = gltf.accessor(values, 5126, type);
    const std::size_t width = type == std::string("VEC4") ? 4 : type == std::string("VEC3") ? 3 : 1;
    gltf.json["accessors"].back()["count"] = values.size() / width;
    const int node = path == std::string("weights") ? 1 : 0;
    gltf.json["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}},
         {"samplers", {{{"input", times}, {"output", output}, {"interpolation", interpolation}}}}}};
    return mean_corner(importer.import(gltf));
  };
  const auto expect_at = [](const Vec3d& actual, const Vec3d& expected) {
    EXPECT_LE((actual - expected).length(), 1e-5) << actual << " is not " << expected;
  };
  const std::vector<float> moves{0, 0, 0, 0, 4, 0, 0, 5, 0};
  expect_at(position_at("translation", "VEC3", moves, "LINEAR", {}), {8, 0, 0});
  expect_at(position_at("translation", "VEC3", moves, "LINEAR", 0), {8, 0, 0});
  expect_at(position_at("translation", "VEC3", moves, "LINEAR", 1.5), {8, 1, 0});
  expect_at(position_at("translation", "VEC3", moves, "STEP", 2.9), {8, 0, 0});
  expect_at(position_at("translation", "VEC3", moves, "STEP", 3), {8, 4, 0});
  expect_at(position_at("translation", "VEC3", moves, "LINEAR", 99), {8, 5, 0});
  expect_at(position_at("scale", "VEC3", {1, 1, 1, 3, 1, 1, 1, 1, 1}, "LINEAR", 2), {16, 0, 0});
  // A quarter turn about Y, its end written as the opposite quaternion: half of it is an eighth.
  const std::vector<float> turns{0, 0, 0, 1, 0, -turn, 0, -turn, 0, turn, 0, turn};
  expect_at(position_at("rotation", "VEC4", turns, "LINEAR", 2), {8 * turn, 0, -8 * turn});
  expect_at(position_at("rotation", "VEC4", turns, "LINEAR", 3.5), {0, 0, -8});
  expect_at(position_at("weights", "SCALAR", {0, 1, 0}, "LINEAR", 2), {8, 0, 0.5});
  // In-tangent, value and out-tangent of each keyframe, interpolated by Hermite's formula.
  const std::vector<float> spline{0, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0};
  expect_at(position_at("translation", "VEC3", spline, "CUBICSPLINE", 2), {8 + 2 + 0.5 - 0.25, 0, 0});
  EXPECT_ERROR(position_at("translation", "VEC3", {0, 0, 0, 1, 1, 1}, "LINEAR", 2), ExitCode::bad_data,
               "2 values for 3 keyframes");
  EXPECT_ERROR(position_at("translation", "VEC3", moves, "QUADRATIC", 2), ExitCode::bad_data, "interpolation must be");
}

}  // namespace
}  // namespace patchlight::test
