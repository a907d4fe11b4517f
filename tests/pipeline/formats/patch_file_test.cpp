#include <cmath>

#include "pipeline/hdf5/h5_store.h"
#include "tests/pipeline/formats/patch_sample.h"

namespace patchlight {
namespace {

using test::expect_refused;
using test::sample;
using test::TemporaryFolder;

TEST(PatchFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  PatchSet scene = sample();
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  ASSERT_EQ(read.patches.size(), scene.patches.size());
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    EXPECT_EQ(read.patches[i].center, scene.patches[i].center);
    EXPECT_EQ(read.patches[i].normal, scene.patches[i].normal);
    EXPECT_EQ(read.patches[i].area, scene.patches[i].area);
    EXPECT_EQ(read.patches[i].emission, scene.patches[i].emission);
    EXPECT_EQ(read.patches[i].u1, scene.patches[i].u1);
  }
  ASSERT_EQ(read.primitives.size(), 3u);
  EXPECT_EQ(read.primitives[2].sphere_radius, -0.5);
  EXPECT_EQ(read.primitives[0].light_group, 0);
  EXPECT_EQ(read.primitives[1].corners, scene.primitives[1].corners);
  EXPECT_EQ(read.cameras[0].to_world, scene.cameras[0].to_world);
  EXPECT_EQ(read.sources[1].path, "b.bin");
  EXPECT_EQ(read.key, scene.key);
  EXPECT_EQ(read.frames_key, scene.frames_key);
  EXPECT_EQ(read.inputs_key, "inputs");
}

TEST(PatchFile, HoldsTheLensesOfCameras) {
  const TemporaryFolder folder;
  const auto file = folder / "patches.h5";
  PatchSet scene = sample();
  write_patches(file, scene);
  for (const char* name : {"/cameras/shift", "/cameras/clip", "/cameras/aperture"})
    EXPECT_FALSE(H5Reader(file, kPatchFormat, kPatchVersion).has(name)) << "a file without them does not grow";
  const std::string plain = scene.key, plain_frames = scene.frames_key;
  scene.cameras.push_back(scene.cameras[0]);
  Camera& camera = scene.cameras[1];
  camera.shift = {0.1, -0.2};
  camera.znear = 0.5;
  camera.aperture = 0.03;
  camera.focus = 4;
  write_patches(file, scene);
  EXPECT_EQ(scene.key, plain) << "a lens never solves again";
  EXPECT_EQ(scene.frames_key, plain_frames);
  const PatchSet read = read_patches(file);
  EXPECT_FALSE(read.cameras[0].has_lens());
  EXPECT_EQ(read.cameras[0].znear, 0);
  EXPECT_EQ(read.cameras[1].shift, camera.shift);
  EXPECT_EQ(read.cameras[1].znear, 0.5);
  EXPECT_TRUE(std::isinf(read.cameras[1].zfar));
  EXPECT_EQ(read.cameras[1].aperture, 0.03);
  EXPECT_EQ(read.cameras[1].focus, 4);
}

/// A camera that turns and walks.
std::vector<Motion> sample_motion() {
  using Interpolation = Motion::Interpolation;
  Motion fixed;
  fixed.values = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 3, 4, 1};
  return {{Motion::Kind::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0}},
          fixed,
          {Motion::Kind::translation, Interpolation::cubic_spline, {0.5}, {0, 0, 0, 7, 8, 9, 0, 0, 0}}};
}

TEST(PatchFile, ReadsBackHowCamerasMoveBesideItsKeys) {
  const TemporaryFolder folder;
  PatchSet still = sample(), moving = sample();
  moving.cameras.push_back(moving.cameras[0]);
  moving.cameras[1].motion = sample_motion();
  write_patches(folder / "a.h5", still);
  write_patches(folder / "b.h5", moving);
  EXPECT_EQ(still.key, moving.key);
  EXPECT_EQ(still.geometry_key, moving.geometry_key);
  const PatchSet read = read_patches(folder / "b.h5");
  EXPECT_TRUE(read.cameras[0].motion.empty());
  ASSERT_EQ(read.cameras[1].motion.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Motion &a = moving.cameras[1].motion[i], &b = read.cameras[1].motion[i];
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.interpolation, b.interpolation);
    EXPECT_EQ(a.times, b.times);
    EXPECT_EQ(a.values, b.values);
  }
}

TEST(PatchFile, KeepsTheKeysOfWhatDidNotChange) {
  const TemporaryFolder folder;
  PatchSet scene = sample(), moved = sample(), repainted = sample(), polished = sample(), smoothed = sample();
  moved.cameras[0].to_world.translate(Vec3d(0, 1, 0));
  repainted.patches[0].reflectance = Color(0.1f);
  scene.materials[0].specular = moved.materials[0].specular = repainted.materials[0].specular =
      smoothed.materials[0].specular = polished.materials[0].specular = Color(0.25f);
  polished.materials[0].roughness = 0.01f;
  smoothed.primitives[0].smooth_vertices[0] = 7;
  write_patches(folder / "a.h5", scene);
  write_patches(folder / "b.h5", moved);
  write_patches(folder / "c.h5", repainted);
  write_patches(folder / "d.h5", polished);
  write_patches(folder / "e.h5", smoothed);
  EXPECT_EQ(scene.key, moved.key);
  EXPECT_NE(scene.key, smoothed.key) << "its vertices gather other light";
  EXPECT_NE(scene.geometry_key, smoothed.geometry_key);
  EXPECT_NE(scene.key, polished.key);
  EXPECT_NE(scene.geometry_key, polished.geometry_key);  // its mirrors send light elsewhere
  PatchSet renamed = sample();
  renamed.materials.push_back(renamed.materials[0]);
  renamed.materials[0].specular = renamed.materials.back().specular = Color(0.25f);
  renamed.materials.back().name = "of one node";
  renamed.primitives[0].material = std::int32_t(renamed.materials.size()) - 1;
  write_patches(folder / "f.h5", renamed);
  EXPECT_EQ(scene.geometry_key, renamed.geometry_key) << "it reflects as it did";
  EXPECT_EQ(scene.geometry_key, repainted.geometry_key);
  EXPECT_NE(scene.key, repainted.key);
  EXPECT_EQ(scene.frames_key, repainted.frames_key);
}

TEST(PatchFile, HoldsIntangibleLamps) {
  const TemporaryFolder folder;
  const auto file = folder / "patches.h5";
  PatchSet scene = sample();
  write_patches(file, scene);
  EXPECT_FALSE(has_intangible(read_patches(file).primitives));
  const std::string key = scene.key, geometry_key = scene.geometry_key;
  scene.primitives[0].intangible = true;
  write_patches(file, scene);
  const PatchSet read = read_patches(file);
  EXPECT_TRUE(read.primitives[0].intangible);
  EXPECT_FALSE(read.primitives[1].intangible);
  EXPECT_NE(scene.key, key);
  EXPECT_NE(scene.geometry_key, geometry_key) << "rays see other surfaces";
}

TEST(PatchFile, KeepsNormals) {
  const TemporaryFolder folder;
  PatchSet scene = sample();
  const Vec3f leaning(0.6f, 0, 0.8f);
  scene.normals = {{leaning, leaning, leaning, Vec3f(0, 0, 1)}, kFlatNormals, kFlatNormals};
  write_patches(folder / "a.h5", scene);
  EXPECT_EQ(read_patches(folder / "a.h5").normals, scene.normals);
  expect_refused(scene, {{"/primitives/normals", [](PatchSet& s) { s.normals[0][1] = Vec3f(0.1f, 0, 0); }}});
}

TEST(PatchFile, RefusesInvalidPatches) {
  expect_refused(sample(), {
                               {"/patches/primitive", [](PatchSet& s) { s.patches[0].primitive = 9; }},
                               {"/patches/uv", [](PatchSet& s) { s.patches[0].u1 = 0.9f; }},
                               {"/patches/uv", [](PatchSet& s) { s.patches.pop_back(); }},
                               {"/patches/uv", [](PatchSet& s) { std::swap(s.patches[0], s.patches[1]); }},
                               {"/patches/area", [](PatchSet& s) { s.patches[0].area = 0; }},
                               {"/patches/center", [](PatchSet& s) { s.patches[0].center.x = NAN; }},
                               {"/patches/normal", [](PatchSet& s) { s.patches[0].normal = Vec3f(2, 0, 0); }},
                               {"/patches/reflectance", [](PatchSet& s) { s.patches[0].reflectance.y = 1.0f; }},
                               {"/patches/emission", [](PatchSet& s) { s.patches[0].emission.x = -1.0f; }},
                               {"/patches/uv", [](PatchSet& s) { s.patches[0].u1 = s.patches[1].u0 = 0.4f; }},
                               {"/patches/uv",
                                [](PatchSet& s) {
                                  for (int i = 0; i < 3; ++i) s.patches[i].v1 = s.patches[i + 3].v0 = 0.4f;
                                }},
                               {"/patches/uv",
                                [](PatchSet& s) {  // three patches in one row and two in the other
                                  s.patches[3].u1 = 0.5f;
                                  s.patches[5].u0 = 0.5f;
                                  s.patches.erase(s.patches.begin() + 4);
                                }},
                               {"/patches/uv", [](PatchSet& s) { s.patches[10].u1 = s.patches[11].u0 = 0.2f; }},
                               {"/patches/area", [](PatchSet& s) { s.patches.clear(); }},
                           });
}

TEST(PatchFile, RefusesInvalidPrimitives) {
  expect_refused(sample(), {
                               {"/primitives/light_group", [](PatchSet& s) { s.primitives[0].light_group = 7; }},
                               {"/primitives/light_group", [](PatchSet& s) { s.primitives[0].light_group = -1; }},
                               {"/primitives/back", [](PatchSet& s) { s.primitives[0].back = 1; }},
                               {"/primitives/material", [](PatchSet& s) { s.primitives[0].material = -1; }},
                               {"/primitives/sphere", [](PatchSet& s) { s.primitives[2].sphere_radius = 0; }},
                               {"/primitives/corners",
                                [](PatchSet& s) { s.primitives[0].corners[1] = s.primitives[0].corners[0]; }},
                               {"/primitives/corners",
                                [](PatchSet& s) {
                                  s.primitives[0].corners = {Vec3d(0), Vec3d(1), Vec3d(2), Vec3d(3)};
                                }},
                               {"/primitives/corners", [](PatchSet& s) { s.primitives[0].corners[1].x = 2e12; }},
                               {"/primitives/sphere", [](PatchSet& s) { s.primitives[2].sphere_center.x = -2e12; }},
                               {"/primitives/sphere", [](PatchSet& s) { s.primitives[2].sphere_radius = NAN; }},
                               {"/primitives/smooth_vertices",
                                [](PatchSet& s) {
                                  s.primitives[0].smooth_vertices = {0, 1, 2, -1};
                                }},
                               {"/primitives/smooth_vertices",
                                [](PatchSet& s) {
                                  s.primitives[1].smooth_vertices = {0, 1, 2, 3};
                                }},
                               {"/primitives/smooth_vertices",
                                [](PatchSet& s) {
                                  s.primitives[2].smooth_vertices = {0, 1, 2, 3};
                                }},
                           });
}

TEST(PatchFile, RefusesInvalidCamerasAndMotions) {
  expect_refused(sample(), {
                               {"/cameras", [](PatchSet& s) { s.cameras[0].vertical = 0; }},
                               {"/cameras", [](PatchSet& s) { s.cameras[0].aperture = 1; }},
                               {"/cameras", [](PatchSet& s) { s.cameras[0].shift.x = NAN; }},
                               {"/cameras", [](PatchSet& s) { s.cameras[0].zfar = -1; }},
                               {"/motions/time",
                                [](PatchSet& s) {
                                  s.cameras[0].motion = sample_motion();
                                  s.cameras[0].motion[0].times = {1, 0};
                                }},
                               {"/motions/value",
                                [](PatchSet& s) {
                                  s.cameras[0].motion = sample_motion();
                                  s.cameras[0].motion[0].values[2] = NAN;
                                }},
                               {"/motions/value",
                                [](PatchSet& s) {
                                  s.cameras[0].motion = sample_motion();
                                  s.cameras[0].motion[2].values.pop_back();
                                }},
                               {"/motions/keys",
                                [](PatchSet& s) {
                                  s.cameras[0].motion = sample_motion();
                                  s.cameras[0].motion[0].times.clear();
                                }},
                               {"/motions/kind",
                                [](PatchSet& s) {
                                  s.cameras[0].motion = sample_motion();
                                  s.cameras[0].motion[1].kind = Motion::Kind(9);
                                }},
                           });
}

}  // namespace
}  // namespace patchlight
