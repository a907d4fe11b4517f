#include "pipeline/driver/commands/starter_job.h"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/patch_scene.h"
#include "tests/pipeline/job/job_file.h"

namespace patchlight::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Every setting that stands in a comment is taken out of it.
std::string uncommented(const std::string& job) {
  std::istringstream lines(job);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = std::min(line.find_first_not_of(' '), line.size());
    if (line.compare(start, 2, "# ") == 0) line.erase(start, 2);
    result += line + "\n";
  }
  return result;
}

/// Two quads, of which one has the material, light group and camera of the name.
PatchSet named_scene(const std::string& name) {
  PatchScene scene;
  scene.get().materials.push_back({name, Color(0.0f), 1.0f});
  scene.get().light_groups = {name};
  scene.get().cameras[0].name = name;
  scene.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 2, 2, {.reflectance = 0.7f});
  scene.quad({{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}}, 1, 1,
             {.reflectance = 0.25f, .emission = 3, .material = 1});
  return scene.get();
}

TEST_F(JobFile, OfASceneNamesItsCamerasGroupsAndMaterials) {
  const std::string text = starter_job("a b.glb", "out", named_scene("lamp"));
  EXPECT_THAT(text, HasSubstr("scene: \"a b.glb\"\noutput: out\n"));
  EXPECT_THAT(text, HasSubstr("  # default: {reflectance: [0.7, 0.7, 0.7]}\n"));
  EXPECT_THAT(text, HasSubstr("  # lamp: {reflectance: [0.25, 0.25, 0.25], emission: [3, 3, 3]}\n"));
  EXPECT_THAT(text, HasSubstr("  lamp: {scale: 1}\n"));
  EXPECT_THAT(text, HasSubstr("  cameras: [lamp]\n"));
  EXPECT_THAT(text, HasSubstr("  # resolution: [640, 480]"));
}

TEST_F(JobFile, OfASceneReadsAnyNameBack) {
  for (const std::string name : {"lamp", "a: b", "#1 \"x\" 'y'", "null", "true", "12", "- a", "K\u00fcche", "{x}, [y]",
                                 "w*ll?", "a\\b\nc", "l.a", "~", " "}) {
    const std::string text = starter_job("a.glb", "out", named_scene(name));
    const Job job = read(text);
    EXPECT_EQ(job.trace.cameras, std::vector<std::string>{name}) << text;
    EXPECT_EQ(job.lights.size(), 1u);
    EXPECT_EQ(job.lights.begin()->first, name);
    EXPECT_TRUE(job.materials.empty());
    const Job all = read(uncommented(text));
    ASSERT_EQ(all.materials.size(), 2u);
    EXPECT_EQ(all.materials[1].emission, Color(3.0f));
    EXPECT_EQ(all.materials[1].pattern == name, name.find_first_of("*?[\\") == std::string::npos);
    EXPECT_TRUE(all.import.patch_area);
    EXPECT_EQ(all.solve.rays, Job().solve.rays);
    EXPECT_EQ(all.trace.samples, Job().trace.samples);
  }
}

TEST_F(JobFile, OfASceneGivesTheShapeOfItsCamera) {
  PatchSet scene = named_scene("a");
  scene.cameras[0].aspect = 16.0 / 9.0;
  EXPECT_EQ(read(uncommented(starter_job("a.glb", "out", scene))).trace.resolution, (std::array{736, 414}));
  scene.cameras[0].aspect = 0.5;
  EXPECT_EQ(read(uncommented(starter_job("a.glb", "out", scene))).trace.resolution, (std::array{392, 784}));
  EXPECT_EQ(read(starter_job("a.glb", "out", scene)).trace.resolution, Job().trace.resolution);
}

TEST_F(JobFile, OfASceneGivesNoReflectanceWhereOneWouldChangeIt) {
  PatchSet scene = named_scene("a");
  scene.primitives[0].texture = 0;
  scene.patches.back().reflectance = Color(0.5f);
  scene.primitives[1].emission_texture = 0;
  const std::string text = starter_job("a.glb", "out", scene);
  EXPECT_THAT(text, HasSubstr("  # default: {}  # reflectance 0.7 0.7 0.7 on average\n"));
  EXPECT_THAT(text, HasSubstr("  # a: {reflectance: [0.5, 0.5, 0.5]}  # its emission varies\n"));
  EXPECT_EQ(read(uncommented(text)).materials.size(), 2u);
}

TEST_F(JobFile, OfASceneGivesMirrorsThatAreSmooth) {
  PatchSet scene = named_scene("a");
  scene.materials[1].specular = Color(0.5f);
  EXPECT_THAT(starter_job("a.glb", "out", scene), Not(HasSubstr("mirror: [")));
  scene.materials[1].roughness = 0;
  EXPECT_THAT(starter_job("a.glb", "out", scene), HasSubstr("mirror: [0.5, 0.5, 0.5], emission: [3, 3, 3]}"));
}

TEST_F(JobFile, OfADarkSceneOffersAnEnvironment) {
  PatchSet scene = named_scene("a");
  scene.light_groups.clear();
  const std::string text = starter_job("a.glb", "out", scene);
  EXPECT_THAT(text, Not(HasSubstr("lights:")));
  EXPECT_FALSE(read(text).environment.is_set());
  EXPECT_TRUE(read(uncommented(text)).environment.is_set());
}

}  // namespace
}  // namespace patchlight::test
