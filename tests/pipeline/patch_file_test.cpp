#include "pipeline/files/patch_file.h"

#include <gtest/gtest.h>

#include <functional>

#include "pipeline/files/patch_check.h"
#include "tests/expect_error.h"
#include "tests/patch_scene.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::read_text;
using test::TemporaryFolder;

PatchSet sample() {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 3, 2, {0.5f, 2.0f});
  builder.quad({{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 1, 1}}}, 2, 2, {});
  builder.sphere({1, 2, 3}, -0.5, 4, 6, {});
  PatchSet scene = builder.get();
  scene.sources = {{"", "abc"}, {"b.bin", "def"}};
  scene.inputs_key = "inputs";
  scene.cameras[0].vertical = 0.5;
  return scene;
}

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

Light sample_light(Light::Kind kind) {
  return {"lamp", kind, 0, Color(1.0f, 2.0f, 3.0f), Vec3d(4, 5, 6), Vec3d(0.6, 0, 0.8), 0.25, 0.5};
}

Environment sample_sky() {
  Environment sky;
  sky.width = 2;
  sky.texels = {Color(1.0f), Color(2.0f, 0.0f, 5.0f)};
  sky.turn = 0.25;
  sky.clip = 4.0f;
  sky.rows = 2;
  sky.cells.assign(8, Color(0.5f));
  return sky;
}

TEST(PatchFile, ReadsBackLights) {
  const TemporaryFolder folder;
  PatchSet dark = sample(), lit = sample();
  for (int kind = 0; kind < 3; ++kind) lit.lights.push_back(sample_light(Light::Kind(kind)));
  write_patches(folder / "a.h5", dark);
  write_patches(folder / "b.h5", lit);
  EXPECT_NE(dark.key, lit.key);
  EXPECT_EQ(dark.geometry_key, lit.geometry_key) << "lights hide nothing";
  const PatchSet read = read_patches(folder / "b.h5");
  ASSERT_EQ(read.lights.size(), 3u);
  for (int kind = 0; kind < 3; ++kind) {
    const Light &a = lit.lights[kind], &b = read.lights[kind];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.strength, b.strength);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(a.inner, b.inner);
    EXPECT_EQ(a.outer, b.outer);
  }
  const std::string key = lit.key;
  lit.lights[0].name = "bulb";
  write_patches(folder / "b.h5", lit);
  EXPECT_EQ(lit.key, key);
  lit.lights[0].position.x = 9;
  write_patches(folder / "b.h5", lit);
  EXPECT_NE(lit.key, key);
}

TEST(PatchFile, ReadsBackAnEnvironment) {
  const TemporaryFolder folder;
  PatchSet dark = sample(), lit = sample();
  lit.environment = sample_sky();
  write_patches(folder / "a.h5", dark);
  write_patches(folder / "b.h5", lit);
  EXPECT_NE(dark.key, lit.key);
  EXPECT_NE(dark.geometry_key, lit.geometry_key) << "rows end on its cells";
  EXPECT_NE(dark.frames_key, lit.frames_key);
  const PatchSet read = read_patches(folder / "b.h5");
  EXPECT_FALSE(read_patches(folder / "a.h5").environment);
  ASSERT_TRUE(read.environment);
  EXPECT_EQ(read.environment->texels, lit.environment->texels);
  EXPECT_EQ(read.environment->cells, lit.environment->cells);
  EXPECT_EQ(read.environment->turn, 0.25);
  EXPECT_EQ(read.environment->clip, 4.0f);
  const PatchSet before = lit;
  lit.environment->cells[3] = Color(0.75f);
  write_patches(folder / "b.h5", lit);
  EXPECT_NE(lit.key, before.key);
  EXPECT_EQ(lit.geometry_key, before.geometry_key) << "another sky needs no ray";
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
  polished.materials[0].roughness = 0.01f;
  smoothed.primitives[0].smooth_vertices[0] = 7;
  write_patches(folder / "a.h5", scene);
  write_patches(folder / "b.h5", moved);
  write_patches(folder / "c.h5", repainted);
  write_patches(folder / "d.h5", polished);
  write_patches(folder / "e.h5", smoothed);
  EXPECT_EQ(scene.key, moved.key);
  EXPECT_EQ(scene.key, smoothed.key);
  EXPECT_NE(scene.frames_key, smoothed.frames_key);
  EXPECT_NE(scene.key, polished.key);
  EXPECT_NE(scene.geometry_key, polished.geometry_key);  // its mirrors send light elsewhere
  EXPECT_EQ(scene.geometry_key, repainted.geometry_key);
  EXPECT_NE(scene.key, repainted.key);
  EXPECT_EQ(scene.frames_key, repainted.frames_key);
}

PatchSet shaded_sample() {
  PatchSet scene = sample();
  scene.shaders = {{"wall", {"u", "v", "1"}, {}}, {"lamp", {}, {"2", "2", "2*x"}}};
  scene.primitives[0].shader = 1;
  scene.primitives[2].shader = 0;
  scene.texcoords.assign(3, kOwnTexcoords);
  scene.texcoords[1] = {Vec2f(0, 0), Vec2f(0.5f, 0), Vec2f(0.5f, 7), Vec2f(0, 7)};
  return scene;
}

TEST(PatchFile, KeepsShaders) {
  const TemporaryFolder folder;
  PatchSet scene = shaded_sample();
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  ASSERT_EQ(read.shaders.size(), 2u);
  EXPECT_EQ(read.shaders[0].name, "wall");
  EXPECT_EQ(read.shaders[0].reflectance, scene.shaders[0].reflectance);
  EXPECT_FALSE(is_set(read.shaders[0].emission));
  EXPECT_EQ(read.shaders[1].emission, scene.shaders[1].emission);
  EXPECT_EQ(read.primitives[0].shader, 1);
  EXPECT_EQ(read.primitives[1].shader, -1);
  EXPECT_EQ(read.texcoords, scene.texcoords);
}

PatchSet textured_sample() {
  PatchSet scene = sample();
  scene.textures = {{2, 1, {Texture::Wrap::mirror, Texture::Wrap::clamp}, true, {0x123456, 0xffffff}},
                    {1, 1, {}, false, {7}}};
  scene.primitives[1].texture = 1;
  scene.materials[0].tint = Color(0.5f, 0.25f, 1.0f);
  scene.texcoords.assign(3, kOwnTexcoords);
  return scene;
}

TEST(PatchFile, KeepsTextures) {
  const TemporaryFolder folder;
  PatchSet scene = textured_sample(), plain = sample();
  write_patches(folder / "plain.h5", plain);
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  ASSERT_EQ(read.textures.size(), 2u);
  EXPECT_EQ(read.textures[0].texels, scene.textures[0].texels);
  EXPECT_EQ(read.textures[0].wrap, scene.textures[0].wrap);
  EXPECT_TRUE(read.textures[0].nearest);
  EXPECT_EQ(read.textures[1].width, 1);
  EXPECT_EQ(read.primitives[0].texture, -1);
  EXPECT_EQ(read.primitives[1].texture, 1);
  EXPECT_EQ(read.materials[0].tint, scene.materials[0].tint);
  EXPECT_EQ(read.texcoords, scene.texcoords);
  EXPECT_EQ(scene.key, plain.key);
  EXPECT_NE(scene.frames_key, plain.frames_key);
}

TEST(PatchFile, RefusesBrokenTextures) {
  const std::vector<std::pair<std::string, std::function<void(PatchSet&)>>> faults{
      {"/textures/shape", [](PatchSet& s) { s.textures[1].width = 2; }},
      {"/textures/shape", [](PatchSet& s) { s.textures[0].height = 0; }},
      {"/textures/shape", [](PatchSet& s) { s.textures[0].wrap[1] = Texture::Wrap(3); }},
      {"/textures/shape", [](PatchSet& s) { s.textures[0].width = s.textures[0].height = 1 << 30; }},
      {"/primitives/texture", [](PatchSet& s) { s.primitives[0].texture = 2; }},
      {"/primitives/texture", [](PatchSet& s) { s.texcoords.clear(); }},
      {"/materials", [](PatchSet& s) { s.materials[0].tint.y = 1.5f; }},
  };
  for (const auto& [where, spoil] : faults) {
    const TemporaryFolder folder;
    PatchSet scene = textured_sample();
    spoil(scene);
    write_patches(folder / "patches.h5", scene);
    EXPECT_ERROR(read_patches(folder / "patches.h5"), ExitCode::bad_data, where);
  }
}

PatchSet masked_sample() {
  PatchSet scene = textured_sample();
  scene.masks = {{2, 1, {Texture::Wrap::clamp, Texture::Wrap::repeat}, false, {0, 255}}};
  scene.primitives[0].mask = 0;
  scene.materials[0].alpha = 0.75f;
  scene.materials[0].alpha_cutoff = 0.5f;
  scene.patches[0].coverage = 0.25f;
  scene.colors.assign(3, kUncolored);
  scene.colors[1][2] = Vec4f(0.25f, 0.5f, 0.75f, 0.125f);
  return scene;
}

TEST(PatchFile, KeepsMasksAndColoursOfVertices) {
  const TemporaryFolder folder;
  PatchSet scene = masked_sample(), plain = textured_sample();
  write_patches(folder / "plain.h5", plain);
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  ASSERT_EQ(read.masks.size(), 1u);
  EXPECT_EQ(read.masks[0].texels, scene.masks[0].texels);
  EXPECT_EQ(read.masks[0].wrap, scene.masks[0].wrap);
  EXPECT_EQ(read.primitives[0].mask, 0);
  EXPECT_EQ(read.primitives[1].mask, -1);
  EXPECT_EQ(read.materials[0].alpha, 0.75f);
  EXPECT_EQ(read.materials[0].alpha_cutoff, 0.5f);
  EXPECT_EQ(read.patches[0].coverage, 0.25f);
  EXPECT_EQ(read.colors, scene.colors);
  EXPECT_NE(scene.geometry_key, plain.geometry_key);
  EXPECT_EQ(read_text(folder / "plain.h5").find("coverage"), std::string::npos);
}

PatchSet finished_sample() {
  PatchSet scene = textured_sample();
  scene.primitives[1].finish_texture = scene.primitives[1].emission_texture = 0;
  scene.primitives[1].light_group = 0;
  scene.materials[std::size_t(scene.primitives[1].material)].metal = Color(0.5f, 0.25f, 0.125f);
  scene.materials[0].finish_roughness = 0.375f;
  scene.materials[0].emission_tint = Color(7.0f, 8.0f, 9.0f);
  scene.finish_texcoords.assign(3, kOwnTexcoords);
  scene.emission_texcoords.assign(3, {Vec2f(1, 2), Vec2f(3, 4), Vec2f(5, 6), Vec2f(7, 8)});
  return scene;
}

TEST(PatchFile, KeepsTexturesOfEmissionAndFinish) {
  const TemporaryFolder folder;
  PatchSet scene = finished_sample(), plain = textured_sample();
  write_patches(folder / "plain.h5", plain);
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  EXPECT_EQ(read.primitives[1].finish_texture, 0);
  EXPECT_EQ(read.primitives[1].emission_texture, 0);
  EXPECT_EQ(read.primitives[0].emission_texture, -1);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) EXPECT_EQ(read.materials[i].metal, scene.materials[i].metal);
  EXPECT_EQ(read.materials[0].finish_roughness, 0.375f);
  EXPECT_EQ(read.materials[0].emission_tint, Color(7.0f, 8.0f, 9.0f));
  EXPECT_EQ(read.finish_texcoords, scene.finish_texcoords);
  EXPECT_EQ(read.emission_texcoords, scene.emission_texcoords);
  EXPECT_NE(scene.geometry_key, plain.geometry_key);
}

TEST(PatchFile, RefusesBrokenMasksAndFinishes) {
  const std::vector<std::pair<std::string, std::function<void(PatchSet&)>>> masks{
      {"/masks/shape", [](PatchSet& s) { s.masks[0].width = 3; }},
      {"/masks/texel", [](PatchSet& s) { s.masks[0].texels[1] = 256; }},
      {"/primitives/mask", [](PatchSet& s) { s.primitives[1].mask = 1; }},
      {"/primitives/mask", [](PatchSet& s) { s.primitives[1].mask = -2; }},
      {"/primitives/mask",  // of one of two sides alone
       [](PatchSet& s) {
         s.primitives[0].back = 1;
         s.primitives[1].back = 0;
       }},
      {"/materials/alpha", [](PatchSet& s) { s.materials[0].alpha = NAN; }},
      {"/patches/coverage", [](PatchSet& s) { s.patches[0].coverage = 0; }},
      {"/primitives/color", [](PatchSet& s) { s.colors[0][0].y = 2; }},
      {"/primitives/color", [](PatchSet& s) { s.colors[0][0].w = NAN; }},
  };
  const std::vector<std::pair<std::string, std::function<void(PatchSet&)>>> finishes{
      {"/primitives/finish_texture", [](PatchSet& s) { s.primitives[1].finish_texture = 2; }},
      {"/primitives/emission_texture", [](PatchSet& s) { s.primitives[0].emission_texture = -2; }},
      {"/primitives/light_group", [](PatchSet& s) { s.primitives[2].emission_texture = 0; }},
      {"/primitives/emission_texcoord", [](PatchSet& s) { s.emission_texcoords[2][3].x = NAN; }},
      {"/materials", [](PatchSet& s) { s.materials[0].finish_roughness = 2; }},
      {"/materials", [](PatchSet& s) { s.materials[0].emission_tint.x = -1; }},
  };
  const auto expect_refused = [](PatchSet scene, const auto& fault) {
    const TemporaryFolder folder;
    fault.second(scene);
    write_patches(folder / "patches.h5", scene);
    EXPECT_ERROR(read_patches(folder / "patches.h5"), ExitCode::bad_data, fault.first);
  };
  for (const auto& fault : masks) expect_refused(masked_sample(), fault);
  for (const auto& fault : finishes) expect_refused(finished_sample(), fault);
}

TEST(PatchFile, SceneWithoutShadersHasNoDatasetsForThem) {
  const TemporaryFolder folder;
  PatchSet scene = sample(), shaded = shaded_sample();
  write_patches(folder / "plain.h5", scene);
  write_patches(folder / "shaded.h5", shaded);
  EXPECT_EQ(read_text(folder / "plain.h5").find("shader"), std::string::npos);
  EXPECT_TRUE(read_patches(folder / "plain.h5").texcoords.empty());
  EXPECT_EQ(scene.key, shaded.key);
  EXPECT_NE(scene.frames_key, shaded.frames_key);
}

TEST(PatchFile, RefusesBrokenShaders) {
  const std::vector<std::pair<std::string, std::function<void(PatchSet&)>>> faults{
      {"/shaders/reflectance", [](PatchSet& s) { s.shaders[0].reflectance[1] = "1+*u"; }},
      {"/shaders/reflectance", [](PatchSet& s) { s.shaders[0].reflectance[0] = ""; }},
      {"/shaders/emission", [](PatchSet& s) { s.shaders[1].emission[2] = "w"; }},
      {"/primitives/shader", [](PatchSet& s) { s.primitives[1].shader = 2; }},
      {"/primitives/shader", [](PatchSet& s) { s.primitives[1].shader = -2; }},
      {"/primitives/light_group", [](PatchSet& s) { s.primitives[1].shader = 1; }},
      {"/primitives/texcoord", [](PatchSet& s) { s.texcoords[1][2].y = INFINITY; }},
      {"/primitives/texcoord", [](PatchSet& s) { s.texcoords.pop_back(); }},
  };
  for (const auto& [where, spoil] : faults) {
    const TemporaryFolder folder;
    PatchSet scene = shaded_sample();
    spoil(scene);
    write_patches(folder / "patches.h5", scene);
    EXPECT_ERROR(read_patches(folder / "patches.h5"), ExitCode::bad_data, where);
  }
}

TEST(PatchFile, RefusesBrokenPromises) {
  const std::vector<std::pair<std::string, std::function<void(PatchSet&)>>> faults{
      {"/patches/primitive", [](PatchSet& s) { s.patches[0].primitive = 9; }},
      {"/patches/uv", [](PatchSet& s) { s.patches[0].u1 = 0.9f; }},
      {"/patches/uv", [](PatchSet& s) { s.patches.pop_back(); }},
      {"/patches/uv", [](PatchSet& s) { std::swap(s.patches[0], s.patches[1]); }},
      {"/patches/area", [](PatchSet& s) { s.patches[0].area = 0; }},
      {"/patches/center", [](PatchSet& s) { s.patches[0].center.x = NAN; }},
      {"/patches/normal", [](PatchSet& s) { s.patches[0].normal = Vec3f(2, 0, 0); }},
      {"/patches/reflectance", [](PatchSet& s) { s.patches[0].reflectance.y = 1.0f; }},
      {"/patches/emission", [](PatchSet& s) { s.patches[0].emission.x = -1.0f; }},
      {"/primitives/light_group", [](PatchSet& s) { s.primitives[0].light_group = 7; }},
      {"/primitives/light_group", [](PatchSet& s) { s.primitives[0].light_group = -1; }},
      {"/primitives/back", [](PatchSet& s) { s.primitives[0].back = 1; }},
      {"/primitives/material", [](PatchSet& s) { s.primitives[0].material = -1; }},
      {"/primitives/sphere", [](PatchSet& s) { s.primitives[2].sphere_radius = 0; }},
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
      {"/primitives/corners", [](PatchSet& s) { s.primitives[0].corners[1] = s.primitives[0].corners[0]; }},
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
      {"/cameras", [](PatchSet& s) { s.cameras[0].vertical = 0; }},
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
      {"/patches/area", [](PatchSet& s) { s.patches.clear(); }},
      {"/lights/light_group", [](PatchSet& s) { s.lights[0].light_group = 1; }},
      {"/lights/strength", [](PatchSet& s) { s.lights[0].strength.y = -1; }},
      {"/lights/strength", [](PatchSet& s) { s.lights[0].strength.y = NAN; }},
      {"/lights/shape", [](PatchSet& s) { s.lights[0].position.z = 1e13; }},
      {"/lights/shape", [](PatchSet& s) { s.lights[0].direction.z = 2; }},
      {"/lights/shape", [](PatchSet& s) { s.lights[0].inner = 0.75; }},
      {"/lights/kind", [](PatchSet& s) { s.lights[0].kind = Light::Kind(3); }},
      {"/environment/light_group", [](PatchSet& s) { s.environment->light_group = -1; }},
      {"/environment/rows", [](PatchSet& s) { s.environment->rows = 0; }},
      {"/environment/cells", [](PatchSet& s) { s.environment->rows = 3; }},
      {"/environment/cells", [](PatchSet& s) { s.environment->cells[2].x = -1; }},
      {"/environment/texels", [](PatchSet& s) { s.environment->texels[1].z = INFINITY; }},
      {"/environment/texels", [](PatchSet& s) { s.environment->width = 3; }},
      {"/environment/size", [](PatchSet& s) { s.environment->height = 0; }},
      {"/environment/view", [](PatchSet& s) { s.environment->turn = NAN; }},
  };
  for (const auto& [where, spoil] : faults) {
    const TemporaryFolder folder;
    PatchSet scene = sample();
    scene.lights = {sample_light(Light::Kind::spot)};
    scene.environment = sample_sky();
    spoil(scene);
    write_patches(folder / "patches.h5", scene);
    EXPECT_ERROR(read_patches(folder / "patches.h5"), ExitCode::bad_data, where);
  }
}

}  // namespace
}  // namespace patchlight
