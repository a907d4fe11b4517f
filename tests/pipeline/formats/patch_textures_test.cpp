#include <cmath>

#include "tests/pipeline/formats/patch_sample.h"

namespace patchlight {
namespace {

using test::expect_refused;
using test::read_text;
using test::sample;
using test::TemporaryFolder;

PatchSet textured_sample() {
  PatchSet scene = sample();
  scene.textures = {{2, 1, {Texture::Wrap::mirror, Texture::Wrap::clamp}, true, {0x123456, 0xffffff}},
                    {1, 1, {}, false, {7}}};
  scene.primitives[1].texture = 1;
  scene.materials[0].tint = Color(0.5f, 0.25f, 1.0f);
  scene.texcoords.assign(3, kIdentityTexcoords);
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
  expect_refused(textured_sample(),
                 {
                     {"/textures/shape", [](PatchSet& s) { s.textures[1].width = 2; }},
                     {"/textures/shape", [](PatchSet& s) { s.textures[0].height = 0; }},
                     {"/textures/shape", [](PatchSet& s) { s.textures[0].wrap[1] = Texture::Wrap(3); }},
                     {"/textures/shape", [](PatchSet& s) { s.textures[0].width = s.textures[0].height = 1 << 30; }},
                     {"/primitives/texture", [](PatchSet& s) { s.primitives[0].texture = 2; }},
                     {"/primitives/texture", [](PatchSet& s) { s.texcoords.clear(); }},
                     {"/materials", [](PatchSet& s) { s.materials[0].tint.y = 1.5f; }},
                 });
}

PatchSet masked_sample() {
  PatchSet scene = textured_sample();
  scene.masks = {{2, 1, {Texture::Wrap::clamp, Texture::Wrap::repeat}, false, {0, 255}}};
  scene.primitives[0].mask = 0;
  scene.materials[0].alpha = 0.75f;
  scene.materials[0].alpha_cutoff = 0.5f;
  scene.patches[0].coverage = 0.25f;
  scene.colors.assign(3, kWhiteVertices);
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
  PatchSet renamed = masked_sample(), sharper = masked_sample();
  renamed.materials.push_back(renamed.materials[0]);
  renamed.primitives[0].material = std::int32_t(renamed.materials.size()) - 1;
  sharper.materials[0].alpha_cutoff = 0.25f;
  write_patches(folder / "renamed.h5", renamed);
  write_patches(folder / "sharper.h5", sharper);
  EXPECT_EQ(renamed.geometry_key, scene.geometry_key) << "its holes are where they were";
  EXPECT_NE(sharper.geometry_key, scene.geometry_key);
}

TEST(PatchFile, RefusesBrokenMasksAndColoursOfVertices) {
  expect_refused(masked_sample(), {
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
                                  });
}

PatchSet finished_sample() {
  PatchSet scene = textured_sample();
  scene.primitives[1].metallic_roughness_texture = scene.primitives[1].emission_texture = 0;
  scene.primitives[1].light_group = 0;
  scene.materials[std::size_t(scene.primitives[1].material)].metal = Color(0.5f, 0.25f, 0.125f);
  scene.materials[0].roughness_factor = 0.375f;
  scene.materials[0].emission_tint = Color(7.0f, 8.0f, 9.0f);
  scene.metallic_roughness_texcoords.assign(3, kIdentityTexcoords);
  scene.primitives[1].normal_texture = 0;
  scene.materials[0].normal_scale = -0.5f;
  scene.normal_texcoords.assign(3, {Vec2f(1, 0), Vec2f(2, 0), Vec2f(2, 1), Vec2f(1, 1)});
  scene.emission_texcoords.assign(3, {Vec2f(1, 2), Vec2f(3, 4), Vec2f(5, 6), Vec2f(7, 8)});
  return scene;
}

TEST(PatchFile, KeepsTexturesOfEmissionAndFinish) {
  const TemporaryFolder folder;
  PatchSet scene = finished_sample(), plain = textured_sample();
  write_patches(folder / "plain.h5", plain);
  write_patches(folder / "patches.h5", scene);
  const PatchSet read = read_patches(folder / "patches.h5");
  EXPECT_EQ(read.primitives[1].metallic_roughness_texture, 0);
  EXPECT_EQ(read.primitives[1].emission_texture, 0);
  EXPECT_EQ(read.primitives[0].emission_texture, -1);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) EXPECT_EQ(read.materials[i].metal, scene.materials[i].metal);
  EXPECT_EQ(read.materials[0].roughness_factor, 0.375f);
  EXPECT_EQ(read.materials[0].emission_tint, Color(7.0f, 8.0f, 9.0f));
  EXPECT_EQ(read.metallic_roughness_texcoords, scene.metallic_roughness_texcoords);
  EXPECT_EQ(read.emission_texcoords, scene.emission_texcoords);
  EXPECT_EQ(read.primitives[1].normal_texture, 0);
  EXPECT_EQ(read.materials[0].normal_scale, -0.5f);
  EXPECT_EQ(read.normal_texcoords, scene.normal_texcoords);
  EXPECT_NE(scene.geometry_key, plain.geometry_key);
}

TEST(PatchFile, RefusesBrokenFinishes) {
  expect_refused(
      finished_sample(),
      {
          {"/primitives/finish_texture", [](PatchSet& s) { s.primitives[1].metallic_roughness_texture = 2; }},
          {"/primitives/emission_texture", [](PatchSet& s) { s.primitives[0].emission_texture = -2; }},
          {"/primitives/normal_texture", [](PatchSet& s) { s.primitives[0].normal_texture = 9; }},
          {"/primitives/normal_texcoord", [](PatchSet& s) { s.normal_texcoords[0][0].y = NAN; }},
          {"/materials", [](PatchSet& s) { s.materials[0].normal_scale = NAN; }},
          {"/primitives/light_group", [](PatchSet& s) { s.primitives[2].emission_texture = 0; }},
          {"/primitives/emission_texcoord", [](PatchSet& s) { s.emission_texcoords[2][3].x = NAN; }},
          {"/materials", [](PatchSet& s) { s.materials[0].roughness_factor = 2; }},
          {"/materials", [](PatchSet& s) { s.materials[0].emission_tint.x = -1; }},
      });
}

PatchSet shaded_sample() {
  PatchSet scene = sample();
  scene.shaders = {{"wall", {"u", "v", "1"}, {}}, {"lamp", {}, {"2", "2", "2*x"}}};
  scene.primitives[0].shader = 1;
  scene.primitives[2].shader = 0;
  scene.texcoords.assign(3, kIdentityTexcoords);
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
  expect_refused(shaded_sample(),
                 {
                     {"/shaders/reflectance", [](PatchSet& s) { s.shaders[0].reflectance[1] = "1+*u"; }},
                     {"/shaders/reflectance", [](PatchSet& s) { s.shaders[0].reflectance[0] = ""; }},
                     {"/shaders/emission", [](PatchSet& s) { s.shaders[1].emission[2] = "w"; }},
                     {"/primitives/shader", [](PatchSet& s) { s.primitives[1].shader = 2; }},
                     {"/primitives/shader", [](PatchSet& s) { s.primitives[1].shader = -2; }},
                     {"/primitives/light_group", [](PatchSet& s) { s.primitives[1].shader = 1; }},
                     {"/primitives/texcoord", [](PatchSet& s) { s.texcoords[1][2].y = INFINITY; }},
                     {"/primitives/texcoord", [](PatchSet& s) { s.texcoords.pop_back(); }},
                 });
}

}  // namespace
}  // namespace patchlight
