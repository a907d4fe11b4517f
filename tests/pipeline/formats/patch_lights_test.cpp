#include <cmath>

#include "tests/pipeline/formats/patch_sample.h"

namespace patchlight {
namespace {

using test::expect_refused;
using test::sample;
using test::TemporaryFolder;

Light sample_light(Light::Kind kind) {
  return {"lamp", kind, 0, Color(1.0f, 2.0f, 3.0f), Vec3d(4, 5, 6), Vec3d(0.6, 0, 0.8), 0.25, 0.5, 0.125};
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
    EXPECT_EQ(a.radius, b.radius);
  }
  const std::string key = lit.key;
  lit.lights[0].name = "bulb";
  write_patches(folder / "b.h5", lit);
  EXPECT_EQ(lit.key, key);
  lit.lights[0].position.x = 9;
  write_patches(folder / "b.h5", lit);
  EXPECT_NE(lit.key, key);
  lit.lights[0].position.x = 4;
  lit.lights[0].radius = 0.25;
  write_patches(folder / "b.h5", lit);
  EXPECT_NE(lit.key, key);
  EXPECT_EQ(lit.geometry_key, dark.geometry_key);
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

TEST(PatchFile, RefusesBrokenLights) {
  PatchSet scene = sample();
  scene.lights = {sample_light(Light::Kind::spot)};
  expect_refused(scene, {
                            {"/lights/light_group", [](PatchSet& s) { s.lights[0].light_group = 1; }},
                            {"/lights/strength", [](PatchSet& s) { s.lights[0].strength.y = -1; }},
                            {"/lights/strength", [](PatchSet& s) { s.lights[0].strength.y = NAN; }},
                            {"/lights/shape", [](PatchSet& s) { s.lights[0].position.z = 1e13; }},
                            {"/lights/shape", [](PatchSet& s) { s.lights[0].direction.z = 2; }},
                            {"/lights/shape", [](PatchSet& s) { s.lights[0].inner = 0.75; }},
                            {"/lights/radius", [](PatchSet& s) { s.lights[0].radius = -1; }},
                            {"/lights/radius", [](PatchSet& s) { s.lights[0].radius = NAN; }},
                            {"/lights/kind", [](PatchSet& s) { s.lights[0].kind = Light::Kind(3); }},
                        });
}

TEST(PatchFile, RefusesBrokenDistributionsOfLights) {
  PatchSet scene = sample();
  scene.lights = {sample_light(Light::Kind::point), sample_light(Light::Kind::sun)};
  scene.lights[0].distribution = 0;
  scene.distributions = {{LightDistribution::System::c, {0, 90}, {0, 180, 360}, {1, 0.5f, 0.25f, 0, 1, 0.5f}}};
  const TemporaryFolder folder;
  write_patches(folder / "a.h5", scene);
  const PatchSet read = read_patches(folder / "a.h5");
  EXPECT_EQ(read.lights[0].distribution, 0);
  EXPECT_EQ(read.lights[1].distribution, -1);
  EXPECT_EQ(read.distributions.at(0).horizontal, scene.distributions[0].horizontal);
  EXPECT_EQ(read.distributions.at(0).intensity, scene.distributions[0].intensity);
  expect_refused(scene, {
                            {"/lights/distribution", [](PatchSet& s) { s.lights[1].distribution = 0; }},
                            {"/lights/distribution", [](PatchSet& s) { s.lights[0].distribution = 1; }},
                            {"/lights/across", [](PatchSet& s) { s.lights[0].across.x = 2; }},
                            {"/distributions/angle", [](PatchSet& s) { s.distributions[0].vertical[1] = 0; }},
                            {"/distributions/angle", [](PatchSet& s) { s.distributions[0].horizontal[2] = NAN; }},
                            {"/distributions/intensity", [](PatchSet& s) { s.distributions[0].intensity[2] = 1.5f; }},
                            {"/distributions/shape", [](PatchSet& s) { s.distributions[0].intensity.pop_back(); }},
                            {"/distributions/shape", [](PatchSet& s) { s.distributions[0].intensity.push_back(0); }},
                            {"/distributions/shape", [](PatchSet& s) { s.distributions[0].vertical.clear(); }},
                            {"/distributions/shape",
                             [](PatchSet& s) { s.distributions[0].system = LightDistribution::System(0); }},
                        });
}

TEST(PatchFile, RefusesABrokenEnvironment) {
  PatchSet scene = sample();
  scene.environment = sample_sky();
  expect_refused(scene, {
                            {"/environment/light_group", [](PatchSet& s) { s.environment->light_group = -1; }},
                            {"/environment/rows", [](PatchSet& s) { s.environment->rows = 0; }},
                            {"/environment/cells", [](PatchSet& s) { s.environment->rows = 3; }},
                            {"/environment/cells", [](PatchSet& s) { s.environment->cells[2].x = -1; }},
                            {"/environment/texels", [](PatchSet& s) { s.environment->texels[1].z = INFINITY; }},
                            {"/environment/texels", [](PatchSet& s) { s.environment->width = 3; }},
                            {"/environment/size", [](PatchSet& s) { s.environment->height = 0; }},
                            {"/environment/view", [](PatchSet& s) { s.environment->turn = NAN; }},
                        });
}

}  // namespace
}  // namespace patchlight
