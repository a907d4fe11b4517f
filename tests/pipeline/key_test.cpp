#include "pipeline/files/key.h"

#include <gtest/gtest.h>

namespace patchlight {
namespace {

TEST(Key, DependsOnWhatCanChangeTheSolution) {
  const SolveConfig usual;
  SolveConfig other = usual;
  other.rays = 512;
  EXPECT_EQ(energy_key("k", usual), energy_key("k", SolveConfig()));
  EXPECT_NE(energy_key("k", usual), energy_key("k", other));
  EXPECT_NE(energy_key("k", usual), energy_key("l", usual));
}

TEST(Key, OfAnImportIgnoresWhereTheSceneStands) {
  const Job job;
  EXPECT_EQ(import_inputs_key({{"a.glb", "hash"}}, job), import_inputs_key({{"b.glb", "hash"}}, job));
  EXPECT_NE(import_inputs_key({{"a.glb", "hash"}}, job), import_inputs_key({{"a.glb", "hush"}}, job));
  EXPECT_NE(import_inputs_key({{"a.gltf", "hash"}, {"x.bin", "hash"}}, job),
            import_inputs_key({{"a.gltf", "hash"}, {"y.bin", "hash"}}, job));
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
  Job plain, lit;
  lit.lights["lamp"];
  EXPECT_EQ(frame_key(scene, "e", plain, "c", 1), frame_key(scene, "e", lit, "c", 1));
  lit.lights["lamp"].scale = 2;
  EXPECT_NE(frame_key(scene, "e", plain, "c", 1), frame_key(scene, "e", lit, "c", 1));
}

TEST(Key, IgnoresTheBench) {
  Job plain, bench;
  bench.bench.sweep = {{{"solve.rays", {"1", "2"}}}};
  bench.bench.camera = "c";
  EXPECT_EQ(import_inputs_key({{"a.glb", "hash"}}, plain), import_inputs_key({{"a.glb", "hash"}}, bench));
  EXPECT_EQ(frame_key(PatchSet(), "e", plain, "c", 1), frame_key(PatchSet(), "e", bench, "c", 1));
}

}  // namespace
}  // namespace patchlight
