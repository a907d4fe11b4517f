#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/optics/lights/direct_light.h"
#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"
#include "tests/importers/photometry/lamp_files.h"

namespace patchlight::test {
namespace {

const double kHalf = std::sqrt(0.5);
const Json kHanging = {{"name", "lamp"}, {"translation", {1, 2, 3}}, {"rotation", {-kHalf, 0, 0, kHalf}}};

std::string lopsided_ies() {
  return ies_text(angles(0, 180, 2.5), angles(0, 360, 5), lopsided);
}

/// A square with a node beside it that holds a light, and the files of lamps.
struct LampScene : Importer {
  GltfBuilder gltf = single_mesh(grid(1));
  Json& node;  ///< Until another node is added.

  explicit LampScene(const Json& light = {{"type", "point"}, {"name", "bulb"}}, const Json& placed = kHanging)
      : node(gltf.json["nodes"][std::size_t(gltf.node(placed))]) {
    std::filesystem::create_directory(folder / "lamps");
    folder.write("lamps/round.ies", ies_text({0, 90, 180}, {0}, [](double, double) { return 683.0; }));
    folder.write("lamp.ies", lopsided_ies());
    folder.write("lamp.ldt", ldt_text(0, 72, 1500, angles(0, 180, 2.5), lopsided));
    if (light.is_null()) return;
    gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  }

  PatchSet scene() { return import(gltf); }
};

/// Irradiance of a small receiver at a place that faces a scene's only light.
Color irradiance_at(const PatchSet& scene, const Vec3d& place) {
  const RayScene rays(scene);
  const DirectLight light(scene, rays, explicit_emitters(scene).back());
  const Vec3f normal((scene.lights.at(0).position - place).normalized());
  return scene.lights[0].strength * float(light.form_factor(place, normal));
}

/// The direction of angles in degrees from a lamp that hangs down: C0 along +X, C90 along -Z.
Vec3d hanging_direction(double vertical, double horizontal) {
  const double v = vertical * kPi / 180, h = horizontal * kPi / 180;
  return {std::sin(v) * std::cos(h), -std::cos(v), -std::sin(v) * std::sin(h)};
}

TEST(PhotometricLights, GiveCandelaOverSquaredDistanceAndLumensAtTwentyAngles) {
  for (const char* file : {"lamp.ies", "lamp.ldt"}) {
    LampScene lamp(Json{{"type", "point"}, {"intensity", 0}});
    lamp.node["extras"]["ies"] = file;
    const PatchSet scene = lamp.scene();
    ASSERT_EQ(scene.lights.size(), 1u) << "the light's own strength does not count";
    for (int k = 0; k < 20; ++k) {
      const double v = 4 + 9 * k, h = std::fmod(k * 77.0, 360.0), distance = 0.5 + 0.3 * k;
      const Color e = irradiance_at(scene, Vec3d(1, 2, 3) + hanging_direction(v, h) * distance);
      const double expected = lopsided(v, h) / (distance * distance) / 683;
      EXPECT_NEAR(e.x, expected, 0.01 * expected) << file << " " << v << " " << h;
      EXPECT_EQ(e.x, e.z);
    }
  }
}

TEST(PhotometricLights, AreWrittenIntoThePatchFile) {
  LampScene lamp;
  lamp.node["extras"]["ies"] = "lamp.ies";
  PatchSet scene = lamp.scene();
  write_patches(lamp.folder / "patches.h5", scene);
  const PatchSet read = read_patches(lamp.folder / "patches.h5");
  ASSERT_EQ(read.distributions.size(), 1u);
  EXPECT_EQ(read.distributions[0].intensity, scene.distributions[0].intensity);
  for (const double h : {10.0, 200.0}) {
    const Vec3d place = Vec3d(1, 2, 3) + hanging_direction(50, h) * 2;
    EXPECT_EQ(irradiance_at(read, place), irradiance_at(scene, place));
  }
  const std::string key = scene.key, geometry = scene.geometry_key;
  scene.distributions[0].intensity[0] *= 0.5f;
  write_patches(lamp.folder / "patches.h5", scene);
  EXPECT_NE(scene.key, key);
  EXPECT_EQ(scene.geometry_key, geometry);
}

TEST(PhotometricLights, TakeTheFileOfTheJobTheNodeOrTheLight) {
  LampScene lamp(Json{{"type", "spot"}, {"name", "bulb"}, {"spot", Json::object()}, {"extras", {{"ies", "lamp.ldt"}}}});
  lamp.job.file = lamp.folder / "job.yaml";
  const auto largest = [&] { return lamp.scene().lights.at(0).strength.x; };
  EXPECT_GT(largest(), 2);
  EXPECT_EQ(lamp.scene().lights[0].kind, Light::Kind::point) << "without the cone of a spot";
  lamp.node["extras"]["ies"] = "lamps/round.ies";
  EXPECT_NEAR(largest(), 1, 1e-6);
  EXPECT_EQ(lamp.scene().sources.back().path, "lamps/round.ies");
  lamp.job.lights["bulb"].ies = lamp.folder / "lamp.ies";
  EXPECT_GT(largest(), 2);
  EXPECT_EQ(lamp.scene().sources.back().path, "lamp.ies");
}

TEST(PhotometricLights, AreTintedTiltedAndHaveARadius) {
  LampScene lamp(Json{{"type", "point"}, {"color", {1, 0.5, 0}}});
  lamp.node["extras"] = {{"ies", "tilted.ies"}, {"radius", 0.25}};
  std::string text = ies_text({0, 90, 180}, {0}, [](double, double) { return 683.0; });
  text.replace(text.find("NONE"), 4, "INCLUDE\n1\n2\n0 90\n1 0.5");
  lamp.folder.write("tilted.ies", text);
  const Light hanging = lamp.scene().lights.at(0);
  EXPECT_EQ(hanging.radius, 0.25);
  EXPECT_NEAR(hanging.strength.x, 1, 1e-6);
  EXPECT_NEAR(hanging.strength.y, 0.5, 1e-6);
  EXPECT_EQ(hanging.strength.z, 0);
  lamp.node.erase("rotation");
  EXPECT_NEAR(lamp.scene().lights.at(0).strength.x, 0.5, 1e-6) << "aims at the horizon";
}

TEST(PhotometricLights, ShareTheDistributionOfTheirFile) {
  LampScene lamp;
  lamp.node["extras"]["ies"] = "lamp.ies";
  Json second = lamp.node;
  second["translation"] = {5, 5, 5};
  lamp.gltf.node(second);
  const PatchSet scene = lamp.scene();
  EXPECT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.distributions.size(), 1u);
  EXPECT_EQ(scene.lights[1].distribution, 0);
}

TEST(PhotometricLights, OfTheExtensionAreReadFromUrisAndBufferViews) {
  for (const bool embedded : {false, true}) {
    LampScene lamp{Json(nullptr)};
    Json profile = {{"name", "profile"}, {"uri", "lamp.ies"}};
    if (embedded) {
      const std::string text = lopsided_ies();
      while (lamp.gltf.binary.size() % 4 != 0) lamp.gltf.binary += '\0';
      lamp.gltf.json["bufferViews"].push_back(
          {{"buffer", 0}, {"byteOffset", lamp.gltf.binary.size()}, {"byteLength", text.size()}});
      lamp.gltf.binary += text;
      profile = {{"bufferView", lamp.gltf.json["bufferViews"].size() - 1}, {"mimeType", "application/x-ies-lm-63"}};
    }
    lamp.gltf.json["extensionsUsed"] = lamp.gltf.json["extensionsRequired"] = {"EXT_lights_ies"};
    lamp.gltf.json["extensions"]["EXT_lights_ies"]["lights"] = {profile};
    lamp.gltf.json["nodes"][1]["extensions"]["EXT_lights_ies"] = {
        {"light", 0}, {"multiplier", 2}, {"color", {1, 0.5, 7}}};
    const PatchSet scene = lamp.scene();
    const Color e = irradiance_at(scene, Vec3d(1, 2, 3) + hanging_direction(40, 100) * 2);
    const double expected = 2 * lopsided(40, 100) / 4 / 683;
    EXPECT_NEAR(e.x, expected, 0.01 * expected);
    EXPECT_NEAR(e.y, 0.5 * e.x, 1e-5);
    EXPECT_NEAR(e.z, e.x, 1e-5) << "colours are at most 1";
    EXPECT_EQ(scene.light_groups.at(0), embedded ? "lamp" : "profile");
  }
}

TEST(PhotometricLights, OutsideOfTheScenesFolderOrMissingAreRefused) {
  LampScene lamp;
  lamp.node["extras"]["ies"] = "../lamp.ies";
  EXPECT_ERROR(lamp.scene(), ExitCode::bad_data, "leaves the scene's folder");
  lamp.node["extras"]["ies"] = "none.ies";
  EXPECT_ERROR(lamp.scene(), ExitCode::missing_input, "none.ies");
  lamp.node["extras"]["ies"] = 7;
  EXPECT_ERROR(lamp.scene(), ExitCode::bad_data, "ies");
  lamp.folder.write("bad.ies", "TILT=NONE\n1 -1 x\n");
  lamp.node["extras"]["ies"] = "bad.ies";
  EXPECT_ERROR(lamp.scene(), ExitCode::bad_data, "bad.ies, line 2");
  lamp.folder.write("tilt.ies", "TILT=../../tilt.tlt\n");
  lamp.node["extras"]["ies"] = "tilt.ies";
  EXPECT_ERROR(lamp.scene(), ExitCode::bad_data, "leaves the scene's folder");
}

TEST(PhotometricLights, AreRefusedForSunsAndEmissiveSurfaces) {
  LampScene sun(Json{{"type", "directional"}, {"name", "sun"}});
  sun.node["extras"]["ies"] = "lamp.ies";
  EXPECT_ERROR(sun.scene(), ExitCode::bad_data, "the sun 'lamp' has a photometric file");
  LampScene lamp;
  lamp.gltf.primitive(0)["material"] = lamp.gltf.material({{"name", "glow"}, {"emissiveFactor", {1, 1, 1}}});
  lamp.job.lights["glow"].ies = lamp.folder / "lamp.ies";
  EXPECT_ERROR(lamp.scene(), ExitCode::bad_config, "has emissive surfaces");
  lamp.job.lights.clear();
  EXPECT_NO_THROW(lamp.scene());
  lamp.gltf.json["nodes"][0]["extras"]["ies"] = "lamp.ies";
  EXPECT_ERROR(lamp.scene(), ExitCode::bad_data, "an emissive mesh has a photometric file");
}

TEST(PhotometricLights, WithMalformedProfilesAreRefused) {
  const auto refused = [](const Json& profile, const Json& use, const std::string& text) {
    LampScene lamp{Json(nullptr)};
    lamp.gltf.json["extensionsUsed"] = {"EXT_lights_ies"};
    lamp.gltf.json["extensions"]["EXT_lights_ies"]["lights"] = {profile};
    lamp.gltf.json["nodes"][1]["extensions"]["EXT_lights_ies"] = use;
    EXPECT_ERROR(lamp.scene(), ExitCode::bad_data, text);
  };
  const Json good = {{"uri", "lamp.ies"}}, use = {{"light", 0}};
  refused({{"name", "a"}}, use, "EXT_lights_ies.lights[0] 'a'");
  refused({{"uri", "lamp.ies"}, {"bufferView", 0}}, use, "either a uri or a bufferView");
  refused({{"bufferView", 99}}, use, "bufferView");
  refused("lamp.ies", use, "must be an object");
  refused(good, Json::object(), "has no light");
  refused(good, {{"light", 1}}, "light");
  refused(good, {{"light", 0}, {"multiplier", -1}}, "multiplier");
  refused(good, {{"light", 0}, {"color", {1, 1}}}, "3 numbers");
}

}  // namespace
}  // namespace patchlight::test
