#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

const float kHalf = std::sqrt(0.5f);

/// A cube, and a camera on node `eye`, whose parent is `dolly`.
struct Shot {
  GltfBuilder gltf = single_mesh(cube());
  int eye = 0, dolly = 0;

  Shot() {
    gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    eye = int(gltf.json["nodes"].size());
    gltf.json["nodes"].push_back({{"camera", 0}, {"name", "eye"}, {"translation", {0, 0, 3}}});
    dolly = gltf.node({{"name", "dolly"}, {"children", {eye}}});
  }

  /// Adds an animation with one channel. Returns its sampler.
  Json& animate(int node, const std::string& path, const std::vector<float>& times, int values,
                const std::string& interpolation = "LINEAR") {
    const int input = gltf.accessor(times, 5126, "SCALAR");
    gltf.json["animations"].push_back(
        {{"name", "walk"},
         {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}},
         {"samplers", {{{"input", input}, {"output", values}, {"interpolation", interpolation}}}}});
    return gltf.json["animations"].back()["samplers"][0];
  }
  Json& animate(int node, const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
                const std::string& interpolation = "LINEAR") {
    const int output = gltf.accessor(values, 5126, path == "rotation" ? "VEC4" : "VEC3");
    Json& accessor = gltf.json["accessors"][output];
    accessor["count"] = values.size() / (path == "rotation" ? 4 : 3);
    return animate(node, path, times, output, interpolation);
  }
};

Vec3d position_at(const PatchSet& scene, double seconds) {
  return to_world_at(scene.cameras.at(0), seconds)->translation();
}

TEST(CameraMotion, IsReadFromTheCamerasNode) {
  Importer importer;
  Shot shot;
  shot.animate(shot.eye, "translation", {1, 2}, std::vector<float>{0, 0, 3, 4, 0, 3});
  const PatchSet scene = importer.import(shot.gltf);
  EXPECT_EQ(scene.cameras[0].to_world.translation(), Vec3d(0, 0, 3)) << "at rest";
  EXPECT_TRUE(position_at(scene, 1.25).equalWithAbsError(Vec3d(1, 0, 3), 1e-6));
  EXPECT_THAT(importer.messages(), ::testing::Not(::testing::HasSubstr("animations")));
}

TEST(CameraMotion, IsReadFromTheCamerasAncestors) {
  Importer importer;
  Shot shot;
  shot.gltf.json["nodes"][shot.dolly]["scale"] = {2, 2, 2};
  shot.gltf.json["nodes"].push_back({{"children", {shot.dolly}}, {"translation", {0, 5, 0}}});
  shot.gltf.json["scenes"][0]["nodes"] = {0, shot.dolly + 1};
  shot.animate(shot.dolly, "rotation", {0, 1}, std::vector<float>{0, 0, 0, 1, 0, kHalf, 0, kHalf});
  const PatchSet scene = importer.import(shot.gltf);
  // A quarter turn about Y takes the eye, 6 m in front of the dolly, to its right.
  EXPECT_TRUE(position_at(scene, 0).equalWithAbsError(Vec3d(0, 5, 6), 1e-6));
  EXPECT_TRUE(position_at(scene, 0.5).equalWithAbsError(Vec3d(6 * kHalf, 5, 6 * kHalf), 1e-6));
  EXPECT_TRUE(position_at(scene, 1).equalWithAbsError(Vec3d(6, 5, 0), 1e-6));
}

TEST(CameraMotion, ReadsStepsSplinesAndSmallIntegers) {
  Importer importer;
  Shot shot;
  shot.animate(shot.eye, "translation", {0, 1}, std::vector<float>{0, 0, 1, 0, 0, 2}, "STEP");
  shot.animate(shot.dolly, "translation", {0, 2},
               std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 12, 0, 0, 8, 0, 0, 0, 0, 0}, "CUBICSPLINE");
  const std::vector<std::int16_t> turns{0, 0, 0, 32767, 0, 23170, 0, 23170};
  const int values = shot.gltf.accessor(turns, 5122, "VEC4");
  shot.gltf.json["accessors"][values]["count"] = 2;
  shot.gltf.json["accessors"][values]["normalized"] = true;
  shot.animate(shot.eye, "rotation", {0, 1}, values);
  const PatchSet scene = importer.import(shot.gltf);
  EXPECT_TRUE(position_at(scene, 0.9).equalWithAbsError(Vec3d(std::pow(0.9, 3), 0, 1), 1e-6));
  EXPECT_TRUE(position_at(scene, 1).equalWithAbsError(Vec3d(1, 0, 2), 1e-6));
  Vec3d back;
  to_world_at(scene.cameras[0], 1)->multDirMatrix(Vec3d(0, 0, 1), back);
  EXPECT_TRUE(back.equalWithAbsError(Vec3d(1, 0, 0), 1e-4));
}

TEST(CameraMotion, OtherAnimationsAreIgnoredWithAWarning) {
  for (const bool carries_a_mesh : {true, false}) {
    Importer importer;
    Shot shot;
    if (carries_a_mesh) {
      shot.gltf.json["nodes"][shot.dolly]["mesh"] = 0;
      shot.animate(shot.dolly, "translation", {0}, std::vector<float>{7, 0, 0});
    } else {
      shot.animate(0, "scale", {0}, std::vector<float>{3, 3, 3});
    }
    const PatchSet scene = importer.import(shot.gltf);
    for (const Primitive& p : scene.primitives) EXPECT_LT(p.corners[0].length(), 2.0);
    EXPECT_EQ(scene.cameras[0].motion.empty(), !carries_a_mesh);
    EXPECT_THAT(importer.messages(), ::testing::HasSubstr("everything else stays in its rest pose"));
  }
}

TEST(CameraMotion, FirstOfSeveralAnimationsIsUsed) {
  Importer importer;
  Shot shot;
  shot.animate(shot.eye, "translation", {0}, std::vector<float>{1, 0, 0});
  shot.animate(shot.eye, "translation", {0}, std::vector<float>{2, 0, 0});
  EXPECT_EQ(position_at(importer.import(shot.gltf), 0), Vec3d(1, 0, 0));
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("the first one is used"));
}

/// Imports a shot with a modified animation, and expects an error whose text contains `text`.
void expect_refused(const std::function<void(Json& json, Json& animation)>& modify, const std::string& text,
                    std::vector<float> times = {0, 1}, float value = 1) {
  Importer importer;
  Shot shot;
  shot.animate(shot.eye, "translation", times, std::vector<float>{0, 0, 0, value, 0, 0});
  shot.gltf.glb();  // fills in the buffer
  modify(shot.gltf.json, shot.gltf.json["animations"][0]);
  EXPECT_ERROR(importer.import(shot.gltf), ExitCode::bad_data, text);
}

TEST(CameraMotion, RefusesBrokenAnimations) {
  using J = Json&;
  const std::string name = "animations[0] 'walk'";
  expect_refused([](J json, J) { json["animations"] = 3; }, "animations");
  expect_refused([](J, J a) { a.erase("samplers"); }, name);
  expect_refused([](J, J a) { a["channels"] = "x"; }, "channels");
  expect_refused([](J, J a) { a["channels"][0] = 7; }, name);
  expect_refused([](J, J a) { a["channels"][0].erase("target"); }, name);
  expect_refused([](J, J a) { a["channels"][0]["target"]["node"] = 99; }, name);
  expect_refused([](J, J a) { a["channels"][0]["target"]["path"] = 1; }, name);
  expect_refused([](J, J a) { a["channels"][0]["sampler"] = 1; }, name);
  expect_refused([](J, J a) { a["channels"][0].erase("sampler"); }, name);
  expect_refused([](J, J a) { a["samplers"][0] = {}; }, name);
  expect_refused([](J, J a) { a["samplers"][0].erase("input"); }, name);
  expect_refused([](J, J a) { a["samplers"][0]["output"] = 99; }, name);
  expect_refused([](J, J a) { a["samplers"][0]["interpolation"] = "SMOOTH"; }, "CUBICSPLINE");
  expect_refused([](J, J a) { a["samplers"][0]["interpolation"] = "CUBICSPLINE"; }, "2 values for 2 keyframes with");
  expect_refused([](J, J a) { a["channels"][0]["target"]["path"] = "rotation"; }, "VEC4");
  expect_refused([](J json, J a) { json["accessors"][a["samplers"][0]["output"].get<int>()]["count"] = 1; },
                 "1 values for 2 keyframes");
  expect_refused([](J json, J a) { json["accessors"][a["samplers"][0]["input"].get<int>()]["count"] = 0; },
                 "no keyframes");
  expect_refused([](J json, J a) { json["accessors"][a["samplers"][0]["input"].get<int>()]["componentType"] = 5125; },
                 "must be SCALAR of floats");
  expect_refused(
      [](J json, J a) {
        Json& accessor = json["accessors"][a["samplers"][0]["output"].get<int>()];
        accessor.erase("bufferView");
        accessor["count"] = 9007199254740991;
      },
      "bufferView");
  expect_refused([](J json, J) { json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; },
                 "which has a matrix");
}

TEST(CameraMotion, RefusesUnsortedAndNonFiniteKeyframes) {
  const auto nothing = [](Json&, Json&) {};
  expect_refused(nothing, "not ascending", {1, 0});
  expect_refused(nothing, "not finite", {0, std::nanf("")});
  expect_refused(nothing, "'eye'", {0, 1}, INFINITY);
}

TEST(CameraMotion, RefusesATransformThatIsNotFinite) {
  Importer importer;
  Shot shot;
  const int outer = shot.dolly + 1;
  shot.gltf.json["nodes"][shot.eye]["scale"] = {1e200, 1, 1};
  shot.gltf.json["nodes"][shot.dolly]["scale"] = {1e200, 1, 1};
  shot.gltf.json["nodes"].push_back(
      {{"children", {shot.dolly}}, {"scale", {1e-200, 1, 1}}});  // their product is finite
  shot.gltf.json["scenes"][0]["nodes"] = {0, outer};
  shot.animate(outer, "rotation", {0}, std::vector<float>{0, 0, 0, 1});
  EXPECT_ERROR(importer.import(shot.gltf), ExitCode::bad_data, "a transform is not finite");
}

TEST(CameraMotion, ManyCamerasOnALongChainAreRefusedQuickly) {
  Importer importer;
  Shot shot;
  constexpr int kDeep = 20000;
  for (int i = 0; i < kDeep; ++i) {
    const int below = i == 0 ? shot.eye : int(shot.gltf.json["nodes"].size()) - 1;
    shot.gltf.json["nodes"].push_back({{"children", {below}}});
  }
  shot.gltf.json["nodes"][shot.dolly]["children"] = {shot.gltf.json["nodes"].size() - 1};
  shot.animate(shot.dolly, "translation", {0}, std::vector<float>{1, 0, 0});
  for (int i = 0; i < kDeep; ++i) {
    shot.gltf.json["nodes"].push_back({{"camera", 0}});
    shot.gltf.json["nodes"][shot.eye]["children"].push_back(shot.gltf.json["nodes"].size() - 1);
  }
  EXPECT_ERROR(importer.import(shot.gltf), ExitCode::over_limit, "keyframes of cameras");
}

TEST(CameraMotion, KeyframesSharedByManyCamerasAreLimited) {
  Importer importer;
  Shot shot;
  shot.animate(shot.dolly, "translation", std::vector<float>(20000, 1.0f), std::vector<float>(60000, 0.0f));
  for (int i = 0; i < 200; ++i) {
    shot.gltf.json["nodes"].push_back({{"camera", 0}});
    shot.gltf.json["nodes"][shot.dolly]["children"].push_back(shot.gltf.json["nodes"].size() - 1);
  }
  EXPECT_ERROR(importer.import(shot.gltf), ExitCode::over_limit, "keyframes of cameras");
}

}  // namespace
}  // namespace patchlight::test
