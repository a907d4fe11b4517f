#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "pipeline/formats/patches/patch_check.h"
#include "pipeline/model/error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

std::filesystem::path scene_folder() {
  const char* folder = std::getenv("PATCHLIGHT_SCENES");
  return folder ? folder : PATCHLIGHT_SCENES;
}

/// Imports the example scenes; skipped if their folder does not exist.
class ExampleScenes : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(scene_folder())) {
      GTEST_SKIP() << "no example scenes in " << scene_folder() << "; set PATCHLIGHT_SCENES to their folder";
    }
  }
  PatchSet import(const std::string& name) { return importer.import_file(scene_folder() / name); }

  Importer importer;
};

std::size_t count(const PatchSet& scene, Primitive::Shape shape) {
  std::size_t result = 0;
  for (const Primitive& p : scene.primitives) result += p.shape == shape && !p.is_triangle();
  return result;
}

TEST_F(ExampleScenes, CornellBoxHasWallsAndBlocks) {
  const PatchSet scene = import("blender/cornell.glb");
  // The left wall of the published data is not planar, so it stays two triangles. The ceiling has a hole for the lamp.
  EXPECT_EQ(count(scene, Primitive::Shape::quad), 15u);
  EXPECT_EQ(scene.primitives.size(), 17u);
  EXPECT_NEAR(total_area(scene), 1.9207, 1e-4);
  EXPECT_EQ(scene.light_groups, std::vector<std::string>{"lights.ceiling"});
  EXPECT_EQ(scene.cameras.at(0).name, "camera");
  EXPECT_FALSE(static_cast<bool>(find_fault(scene)));
}

TEST_F(ExampleScenes, GalleryHasLightGroupsCamerasAndASphere) {
  const PatchSet scene = import("blender/gallery.glb");
  EXPECT_EQ(std::set<std::string>(scene.light_groups.begin(), scene.light_groups.end()),
            (std::set<std::string>{"lights.day", "lights.lamp", "lights.screen"}));
  EXPECT_EQ(scene.cameras.size(), 4u);
  ASSERT_EQ(count(scene, Primitive::Shape::sphere), 1u);
  for (const Primitive& p : scene.primitives) {
    if (p.shape == Primitive::Shape::sphere) {
      EXPECT_NEAR(p.sphere_radius, 0.12, 1e-6);
    }
  }
  EXPECT_FALSE(static_cast<bool>(find_fault(scene)));
}

TEST_F(ExampleScenes, CameraMotionOfTheGalleryMatchesBlender) {
  const PatchSet scene = import("blender/gallery.glb");
  const auto walkthrough = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                        [](const Camera& camera) { return camera.name == "cam_walk"; });
  ASSERT_NE(walkthrough, scene.cameras.end());
  const auto frame = [&](int number) { return *to_world_at(*walkthrough, number / 24.0); };
  EXPECT_TRUE(frame(1).translation().equalWithAbsError(Vec3d(1, 1.65, -4.2), 1e-5));
  EXPECT_TRUE(frame(1).equalWithAbsError(walkthrough->to_world, 1e-6)) << "the first frame equals the node's transform";
  EXPECT_TRUE(frame(2).translation().equalWithAbsError(Vec3d(1.0420537, 1.65, -4.2), 1e-5));
  EXPECT_TRUE(frame(120).translation().equalWithAbsError(Vec3d(8.6, 1.65, -7), 1e-5));
  EXPECT_TRUE(frame(119).translation() != frame(120).translation());
  EXPECT_EQ(std::count_if(scene.cameras.begin(), scene.cameras.end(),
                          [](const Camera& camera) { return !camera.motion.empty(); }),
            1);
}

TEST_F(ExampleScenes, SeparateFilesGiveTheSameScene) {
  const PatchSet packed = import("blender/gallery.glb");
  const PatchSet separate = import("blender/gallery/gallery.gltf");
  ASSERT_EQ(packed.patches.size(), separate.patches.size());
  for (std::size_t i = 0; i < packed.patches.size(); ++i) {
    ASSERT_EQ(packed.patches[i].center, separate.patches[i].center);
    ASSERT_EQ(packed.patches[i].reflectance, separate.patches[i].reflectance);
  }
  EXPECT_GT(separate.sources.size(), 2u);
}

TEST_F(ExampleScenes, SphereFurnaceIsOneInwardSphere) {
  const PatchSet scene = import("blender/sphere_furnace.glb");
  ASSERT_EQ(scene.primitives.size(), 1u);
  EXPECT_NEAR(scene.primitives[0].sphere_radius, -1.0, 1e-6);
  EXPECT_NEAR(total_area(scene), 4 * kPi, 1e-5);
  EXPECT_NEAR(scene.patches[0].emission.x, 2 * kPi, 1e-5);
}

TEST_F(ExampleScenes, FurnaceIsSixInwardQuads) {
  const PatchSet scene = import("blender/furnace_r050.glb");
  ASSERT_EQ(scene.primitives.size(), 6u);
  EXPECT_NEAR(total_area(scene), 24.0, 1e-5);
  for (const Primitive& p : scene.primitives) EXPECT_LT(facing(p).dot(p.corners[0]), 0.0);
}

TEST_F(ExampleScenes, MalformedFilesAreRefusedOrImportedCompletely) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scene_folder() / "malformed")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    ++files;
    try {
      const PatchSet scene = importer.import_file(entry.path());
      EXPECT_FALSE(static_cast<bool>(find_fault(scene))) << entry.path();
    } catch (const Error& error) {
      const bool expected = error.code() == ExitCode::bad_data || error.code() == ExitCode::missing_input;
      EXPECT_TRUE(expected) << entry.path() << ": " << error.what();
    }
  }
  EXPECT_GT(files, 100);
}

}  // namespace
}  // namespace patchlight::test
