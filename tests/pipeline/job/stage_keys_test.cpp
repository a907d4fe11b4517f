#include "pipeline/job/stage_keys.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

TEST(Key, DependsOnWhatCanChangeTheSolution) {
  const SolveConfig usual;
  SolveConfig other = usual;
  other.rays = 512;
  EXPECT_EQ(energy_key("k", usual), energy_key("k", SolveConfig()));
  EXPECT_NE(energy_key("k", usual), energy_key("k", other));
  EXPECT_NE(energy_key("k", usual), energy_key("l", usual));
  other = usual;
  other.hemicube_resolution = 64;
  EXPECT_EQ(energy_key("k", usual), energy_key("k", other));  // rays know no cells
  SolveConfig hemicube = usual, coarse = other;
  hemicube.form_factors = coarse.form_factors = "hemicube";
  EXPECT_NE(energy_key("k", hemicube), energy_key("k", coarse));
  coarse = hemicube;
  coarse.rays = 512;
  EXPECT_NE(energy_key("k", hemicube), energy_key("k", coarse));  // they see the emitters
  hemicube.method = coarse.method = "progressive";
  EXPECT_NE(energy_key("k", hemicube), energy_key("k", coarse)) << "the display solution is gathered by rays";
  hemicube.display = coarse.display = false;
  EXPECT_EQ(energy_key("k", hemicube), energy_key("k", coarse));
}

TEST(Key, OfATransportDependsOnWhatRowsAreMadeFrom) {
  const SolveConfig usual;
  SolveConfig other = usual;
  other.tolerance = 0.5;
  other.hemicube_resolution = 64;
  EXPECT_EQ(transport_key("g", usual), transport_key("g", other));
  EXPECT_NE(transport_key("g", usual), transport_key("h", usual));
  other.form_factors = "hemicube";
  EXPECT_NE(transport_key("g", usual), transport_key("g", other));
  other = usual;
  other.seed = 2;
  EXPECT_NE(transport_key("g", usual), transport_key("g", other));
}

TEST(Key, OfAnImportIgnoresWhereTheSceneStands) {
  const Job job;
  EXPECT_EQ(import_inputs_key({{"a.glb", "hash"}}, job), import_inputs_key({{"b.glb", "hash"}}, job));
  EXPECT_NE(import_inputs_key({{"a.glb", "hash"}}, job), import_inputs_key({{"a.glb", "hush"}}, job));
  EXPECT_NE(import_inputs_key({{"a.gltf", "hash"}, {"x.bin", "hash"}}, job),
            import_inputs_key({{"a.gltf", "hash"}, {"y.bin", "hash"}}, job));
}

TEST(Key, OfAnImportHoldsEveryOverrideAndTheTime) {
  std::vector<Job> jobs(10);
  jobs[1].materials = {{"x"}};
  jobs[2].nodes = {{"x"}};
  jobs[9].import.time = 0.0;
  for (std::size_t i = 3; i < 9; ++i) jobs[i].nodes = {{"x"}};
  jobs[3].nodes[0].reflectance = Color(0.5f);
  jobs[4].nodes[0].emission = Color(0.5f);
  jobs[5].nodes[0].mirror = Color(0.5f);
  jobs[6].nodes[0].light_group = "a";
  jobs[7].nodes[0].patch_area = 0.5;
  jobs[8].nodes[0].exclude = true;
  std::set<std::string> keys;
  for (const Job& job : jobs) keys.insert(import_inputs_key({{"a.glb", "hash"}}, job));
  EXPECT_EQ(keys.size(), jobs.size());
}

TEST(Key, OfAnImportHoldsTheEnvironmentAndTheUnitsOfLights) {
  std::vector<Job> jobs(8);
  for (Job& job : jobs) job.scene = "/scenes/a.glb";
  jobs[1].import.punctual_units = "raw";
  for (std::size_t i = 2; i < 8; ++i) jobs[i].environment.color = Color(1.0f);
  jobs[3].environment.color = Color(2.0f);
  jobs[4].environment.image = "/skies/b.hdr";
  jobs[5].environment.strength = 2;
  jobs[6].environment.rotation = 2;
  jobs[7].environment.light_group = "sky";
  std::set<std::string> keys;
  for (const Job& job : jobs) keys.insert(import_inputs_key({{"a.glb", "hash"}}, job));
  EXPECT_EQ(keys.size(), jobs.size());
  Job elsewhere = jobs[4];
  elsewhere.scene = "/new/scenes/a.glb";
  elsewhere.environment.image = "/new/skies/./b.hdr";
  EXPECT_TRUE(keys.contains(import_inputs_key({{"a.glb", "hash"}}, elsewhere)));
}

TEST(Key, OfAnImportHoldsEveryExpression) {
  Job plain, reflecting, emitting;
  reflecting.shaders = {{"wall", {"u", "v", "1"}, {}}};
  emitting.shaders = {{"wall", {}, {"u", "v", "1"}}};
  const auto key = [](const Job& job) { return import_inputs_key({{"a.glb", "hash"}}, job); };
  EXPECT_NE(key(plain), key(reflecting));
  EXPECT_NE(key(reflecting), key(emitting));
  reflecting.shaders[0].reflectance[2] = "2";
  EXPECT_NE(key(reflecting), key(emitting));
}

TEST(Key, OfAFrameIgnoresLightsAtTheirOwnStrength) {
  PatchSet scene;
  scene.cameras.resize(1);
  Job plain, lit;
  lit.lights["lamp"];
  EXPECT_EQ(frame_key(scene, "e", plain, scene.cameras[0], 1, "v"),
            frame_key(scene, "e", lit, scene.cameras[0], 1, "v"));
  lit.lights["lamp"].scale = 2;
  EXPECT_NE(frame_key(scene, "e", plain, scene.cameras[0], 1, "v"),
            frame_key(scene, "e", lit, scene.cameras[0], 1, "v"));
}

TEST(Key, OfAFrameCoversItsOwnCameraAlone) {
  PatchSet scene;
  scene.cameras.resize(2);
  PatchSet moved = scene;
  moved.cameras[1].to_world.translate(Vec3d(0, 1, 0));
  EXPECT_EQ(frame_key(scene, "e", {}, scene.cameras[0], 1, "v"), frame_key(moved, "e", {}, moved.cameras[0], 1, "v"));
  EXPECT_NE(frame_key(scene, "e", {}, scene.cameras[1], 1, "v"), frame_key(moved, "e", {}, moved.cameras[1], 1, "v"));
}

TEST(Key, OfAFrameCoversWhereTheCameraStandsThen) {
  const PatchSet scene;
  Camera camera, moved;
  moved.to_world.translate(Vec3d(0, 1, 0));
  EXPECT_NE(frame_key(scene, "e", {}, camera, 1, "v"), frame_key(scene, "e", {}, moved, 1, "v"));
  Job faster;  // what it changes is where the camera stands
  faster.trace.fps = 48;
  faster.trace.frames = "1-9";
  EXPECT_EQ(frame_key(scene, "e", {}, camera, 1, "v"), frame_key(scene, "e", faster, camera, 1, "v"));
}

TEST(Key, OfAFrameCoversWhatItsFileHolds) {
  PatchSet scene;
  scene.cameras.resize(1);
  const Job plain;
  std::set<std::string> keys{frame_key(scene, "e", plain, Camera(), 1, "v")};
  Job job;
  job.trace.layers = {"depth"};
  keys.insert(frame_key(scene, "e", job, Camera(), 1, "v"));
  job.trace.layers = {"depth", "patch"};
  keys.insert(frame_key(scene, "e", job, Camera(), 1, "v"));
  job.trace.pixel_type = "float";
  keys.insert(frame_key(scene, "e", job, Camera(), 1, "v"));
  job.trace.compression = "piz";
  keys.insert(frame_key(scene, "e", job, Camera(), 1, "v"));
  EXPECT_EQ(keys.size(), 5u);
}

TEST(Key, IgnoresTheBench) {
  Job plain, bench;
  bench.bench.sweep = {{{"solve.rays", {"1", "2"}}}};
  bench.bench.camera = "c";
  EXPECT_EQ(import_inputs_key({{"a.glb", "hash"}}, plain), import_inputs_key({{"a.glb", "hash"}}, bench));
  PatchSet scene;
  scene.cameras.emplace_back().name = "c";
  EXPECT_EQ(frame_key(scene, "e", plain, scene.cameras[0], 1, "v"),
            frame_key(scene, "e", bench, scene.cameras[0], 1, "v"));
}

}  // namespace
}  // namespace patchlight
