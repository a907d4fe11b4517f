#include <gtest/gtest.h>

#include <cmath>

#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// A square with one light on a node beside it.
GltfBuilder lit_scene(const Json& light, Json node = Json::object()) {
  GltfBuilder gltf = single_mesh(grid(1));
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
  node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  gltf.node(node);
  return gltf;
}

PatchSet imported(const Json& light, const Json& node = Json::object(), const std::string& units = "blender") {
  Importer importer;
  importer.job.import.punctual_units = units;
  GltfBuilder gltf = lit_scene(light, node);
  return importer.import(gltf);
}

void expect_refused(const Json& light, const std::string& text) {
  Importer importer;
  GltfBuilder gltf = lit_scene(light);
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, text);
}

TEST(Lights, PropertiesOfOtherParentsAreTheirOwn) {
  GltfBuilder gltf = lit_scene({{"type", "point"}}, {{"name", "lamp"}});
  gltf.json["nodes"].push_back({{"name", "rig"}, {"children", {1}}, {"extras", {{"radius", "big"}, {"angle", 270}}}});
  gltf.json["scenes"][0]["nodes"] = {0, 2};
  Importer importer;
  EXPECT_EQ(importer.import(gltf).lights.at(0).radius, 0);
  gltf.json["nodes"][1]["name"] = "rig_Orientation";
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "radius");
}

TEST(Lights, PowerOfABlenderLampIsRestored) {
  // A point lamp of 100 W as Blender 3.4 exports it by default; Cycles' intensity is 100 / (4 pi).
  const PatchSet scene = imported({{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 100 * 683 / (4 * kPi)}},
                                  {{"name", "bulb"}, {"translation", {1, 2, 3}}, {"scale", {4, 5, 6}}});
  ASSERT_EQ(scene.lights.size(), 1u);
  const Light& light = scene.lights[0];
  EXPECT_EQ(light.kind, Light::Kind::point);
  EXPECT_EQ(light.name, "bulb");
  EXPECT_EQ(light.position, Vec3d(1, 2, 3));
  EXPECT_NEAR(light.strength.x, 100 / (4 * kPi), 1e-5);
  EXPECT_NEAR(light.strength.y, 50 / (4 * kPi), 1e-5);
  EXPECT_EQ(light.strength.z, 0);
}

TEST(Lights, UnitsAreSetByTheJob) {
  const Json sun = {{"type", "directional"}, {"intensity", 683 * 3}};
  EXPECT_NEAR(imported(sun).lights.at(0).strength.x, 3, 1e-6);
  EXPECT_NEAR(imported(sun, {}, "si").lights.at(0).strength.x, 3, 1e-6);
  EXPECT_NEAR(imported(sun, {}, "raw").lights.at(0).strength.x, 683 * 3, 1e-3);
}

TEST(Lights, PointAlongMinusZOfTheirNode) {
  const double h = std::sqrt(0.5);
  const Json down = {{"rotation", {-h, 0, 0, h}}, {"scale", {2, 3, 4}}, {"translation", {0, 5, 0}}};
  const Light spot =
      imported({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}}, down).lights.at(0);
  EXPECT_LT((spot.direction - Vec3d(0, -1, 0)).length(), 1e-12);
  EXPECT_EQ(spot.position, Vec3d(0, 5, 0));
  EXPECT_EQ(spot.inner, 0.2);
  EXPECT_EQ(spot.outer, 0.4);
  const Light sun = imported({{"type", "directional"}}, down).lights.at(0);
  EXPECT_LT((sun.direction - Vec3d(0, -1, 0)).length(), 1e-12);
  EXPECT_EQ(sun.position, Vec3d(0.0)) << "the position of a sun's node has no effect";
  const Light defaults = imported({{"type", "spot"}, {"spot", Json::object()}}).lights.at(0);
  EXPECT_EQ(defaults.inner, 0);
  EXPECT_NEAR(defaults.outer, kPi / 4, 1e-12);
}

TEST(Lights, FollowAnimationsAtImportTime) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "point"}}, {{"translation", {9, 9, 9}}});
  const int times = gltf.accessor(std::vector<float>{0, 2}, 5126, "SCALAR");
  const int positions = gltf.accessor(std::vector<Vec3f>{Vec3f(0.0f), Vec3f(4, 8, 0)}, 5126, "VEC3");
  gltf.json["animations"] = {{{"samplers", {{{"input", times}, {"output", positions}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
  EXPECT_EQ(importer.import(gltf).lights.at(0).position, Vec3d(9, 9, 9));
  importer.job.import.time = 1.0;
  EXPECT_EQ(importer.import(gltf).lights.at(0).position, Vec3d(2, 4, 0));
}

TEST(Lights, GroupsAreNamedByNodeThenLight) {
  const auto group = [](const Json& light, const Json& node) { return imported(light, node).light_groups.at(0); };
  const Json own = {{"extras", {{"light_group", "of/node"}}}};
  const Json light = {{"type", "point"}, {"name", "Lamp"}, {"extras", {{"light_group", "of light"}}}};
  EXPECT_EQ(group(light, own), "of_node");
  EXPECT_EQ(group(light, Json::object()), "of light");
  EXPECT_EQ(group({{"type", "point"}, {"name", "Lamp"}}, Json::object()), "Lamp");
  EXPECT_EQ(group({{"type", "point"}}, {{"name", "bulb"}}), "bulb");
}

TEST(Lights, TakeTheNameOfTheLampAboveBlendersOrientationNode) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "point"}, {"name", "data"}}, {{"name", "Lamp_Orientation"}});
  gltf.json["nodes"].push_back({{"name", "Lamp"}, {"children", {1}}, {"extras", {{"light_group", "warm"}}}});
  gltf.json["scenes"][0]["nodes"] = {0, 2};
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.lights.at(0).name, "Lamp");
  EXPECT_EQ(scene.light_groups.at(0), "warm");
  importer.job.nodes.push_back({"La*"});
  importer.job.nodes[0].light_group = "cold";
  EXPECT_EQ(importer.import(gltf).light_groups.at(0), "cold");
  importer.job.nodes[0].exclude = true;
  EXPECT_TRUE(importer.import(gltf).lights.empty());
  EXPECT_TRUE(importer.import(gltf).light_groups.empty());
}

TEST(Lights, HaveTheSizeThatTheJobTheNodeOrTheLightGives) {
  const Json own = {{"extras", {{"radius", 0.25}, {"angle", 4}}}};
  const Json point = {{"type", "point"}, {"name", "bulb"}, {"extras", {{"radius", 0.5}}}};
  const Json sun = {{"type", "directional"}, {"name", "sun"}, {"extras", {{"angle", 2.0}}}};
  EXPECT_EQ(imported({{"type", "point"}}).lights.at(0).radius, 0);
  EXPECT_EQ(imported({{"type", "directional"}}).lights.at(0).outer, 0);
  EXPECT_EQ(imported(point).lights.at(0).radius, 0.5);
  EXPECT_EQ(imported(point, own).lights.at(0).radius, 0.25);
  EXPECT_NEAR(imported(sun).lights.at(0).outer, kPi / 180, 1e-15) << "half of the angle";
  EXPECT_NEAR(imported(sun, own).lights.at(0).outer, 2 * kPi / 180, 1e-15);
  EXPECT_EQ(imported(sun, own).lights.at(0).radius, 0);
  Importer importer;
  importer.job.lights["bulb"].radius = 0.125;
  GltfBuilder gltf = lit_scene(point, own);
  EXPECT_EQ(importer.import(gltf).lights.at(0).radius, 0.125);
  importer.job.lights["bulb"].radius = 0;
  EXPECT_EQ(importer.import(gltf).lights.at(0).radius, 0);
}

TEST(Lights, HaveTheSizeOfTheLampAboveBlendersOrientationNode) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "point"}}, {{"name", "Lamp_Orientation"}});
  gltf.json["nodes"].push_back({{"name", "Lamp"}, {"children", {1}}, {"extras", {{"radius", 1}}}});
  gltf.json["scenes"][0]["nodes"] = {0, 2};
  EXPECT_EQ(importer.import(gltf).lights.at(0).radius, 1);
}

TEST(Lights, OfTheWrongSizeAreRefused) {
  for (const Json& value : {Json(-1), Json("0.1"), Json(1e7), Json::array()}) {
    expect_refused({{"type", "point"}, {"name", "bulb"}, {"extras", {{"radius", value}}}},
                   "lights[0] 'bulb'.extras.radius");
    Importer importer;
    GltfBuilder gltf = lit_scene({{"type", "directional"}}, {{"name", "sun"}, {"extras", {{"angle", value}}}});
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "nodes[1] 'sun'.extras.angle");
    gltf.json["nodes"][1].erase("extensions");
    EXPECT_NO_THROW(importer.import(gltf)) << "properties of other nodes may mean anything";
  }
}

TEST(Lights, SizesThatTheJobSetsForOtherLightsAreRefused) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "point"}, {"name", "bulb"}});
  importer.job.lights["bulb"].angle = 1;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_config, "the light group `bulb` has no sun");
  importer.job.lights["bulb"].angle.reset();
  importer.job.lights["blub"].radius = 1;
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_config, "the scene's light groups are: bulb");
}

TEST(Lights, ShareGroupsWithSurfaces) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "point"}, {"name", "lamp"}});
  gltf.primitive(0)["material"] = gltf.material({{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}});
  const PatchSet scene = importer.import(gltf);
  EXPECT_EQ(scene.light_groups.size(), 1u);
  EXPECT_EQ(scene.lights.at(0).light_group, scene.primitives.at(0).light_group);
}

TEST(Lights, WithoutStrengthAreIgnored) {
  const PatchSet scene = imported({{"type", "point"}, {"intensity", 0}});
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_TRUE(scene.light_groups.empty());
}

TEST(Lights, OfUnknownTypesAreIgnored) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "spherical"}});
  EXPECT_TRUE(importer.import(gltf).lights.empty());
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("unknown types"));
}

TEST(Lights, MalformedOnesAreRefused) {
  const auto spot = [](const Json& cone) { return Json{{"type", "spot"}, {"spot", cone}}; };
  expect_refused(Json::object(), "has no type");
  expect_refused({{"type", "point"}, {"name", "bulb"}, {"intensity", -1}}, "lights[0] 'bulb'.intensity");
  expect_refused({{"type", "point"}, {"intensity", "5"}}, "intensity");
  expect_refused({{"type", "point"}, {"color", {1, -1, 1}}}, "color");
  expect_refused({{"type", "point"}, {"color", {1, 1}}}, "3 numbers");
  expect_refused({{"type", "point"}, {"intensity", 1e300}}, "strength");
  expect_refused({{"type", "point"}, {"range", 0}}, "range");
  expect_refused({{"type", 7}}, "type");
  expect_refused({{"type", "spot"}}, "without cone angles");
  expect_refused(spot({{"innerConeAngle", 0.2}, {"outerConeAngle", 0.1}}), "inner <= outer");
  expect_refused(spot({{"outerConeAngle", 1.6}}), "pi/2");
  expect_refused(spot({{"innerConeAngle", -0.1}}), "negative");
  expect_refused("lamp", "must be an object");
}

TEST(Lights, IndicesOutOfRangeAreRefused) {
  for (const Json& index : {Json(1), Json(-1), Json("0")}) {
    Importer importer;
    GltfBuilder gltf = lit_scene({{"type", "point"}});
    gltf.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = index;
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "nodes[1].light");
  }
}

TEST(Lights, NonFinitePositionsAreRefused) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "point"}}, {{"name", "bulb"}, {"translation", {1e300, 0, 0}}});
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "bulb");
}

TEST(Lights, TooManyAreRefused) {
  Importer importer;
  GltfBuilder gltf = lit_scene({{"type", "point"}});
  for (int k = 0; k < 1000; ++k) gltf.node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  EXPECT_ERROR(importer.import(gltf), ExitCode::over_limit, "more than 1000 lights");
}

TEST(Lights, NodesOfWhichCamerasSeeNothingAreMarked) {
  for (const Json& value : {Json(false), Json(0)}) {
    GltfBuilder gltf = single_mesh(grid(1));
    Importer importer;
    EXPECT_TRUE(importer.import(gltf).unseen.empty());
    gltf.json["nodes"][0]["extras"] = {{"visible_camera", value}};
    const PatchSet scene = importer.import(gltf);
    ASSERT_EQ(scene.unseen.size(), scene.nodes.size());
    EXPECT_EQ(scene.unseen[scene.primitives[0].node], 1);
  }
}

TEST(Lights, LampsThatReflectNothingMayBeIntangible) {
  Json lamp{{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}};
  for (const double reflectance : {0.0, 0.5}) {
    lamp["pbrMetallicRoughness"] = {{"baseColorFactor", {reflectance, 0, 0, 1}}, {"metallicFactor", 0}};
    GltfBuilder gltf = single_mesh(grid(1), lamp);
    Importer importer;
    EXPECT_FALSE(has_intangible(importer.import(gltf).primitives));
    gltf.json["nodes"][0]["extras"] = {{"intangible", true}};
    EXPECT_EQ(has_intangible(importer.import(gltf).primitives), reflectance == 0);
    EXPECT_EQ(importer.messages().find("not a lamp that reflects nothing") == std::string::npos, reflectance == 0);
  }
}

}  // namespace
}  // namespace patchlight::test
