#include "pipeline/job/reader/job_reader.h"
#include "tests/pipeline/job/job_file.h"

namespace patchlight {
namespace {

using test::JobFile;
using test::kMinimal;

TEST_F(JobFile, GivesDefaultsToAbsentKeys) {
  const Job job = read(kMinimal);
  EXPECT_FALSE(job.import.patch_area);
  EXPECT_EQ(job.solve.rays, 256);
  EXPECT_FALSE(job.trace.resolution);
  EXPECT_EQ(job.patch_file(), folder_.path() / "out" / "patches.h5");
}

TEST_F(JobFile, ReadsEveryKeyOfTheContract) {
  const Job job = read(R"(
scene: sub/a.glb
output: out
import: {patch_area: 0.0025, time: 2.5}
materials:
  red_wall: {reflectance: [0.6, 0.1, 0.1]}
solve: {method: matrix, form_factors: rays, rays: 64, display: true, hemicube_resolution: 128, tolerance: 1.0e-3}
lights:
  lights.lamp: {scale: 2.0, color: [1, 0.8, 0.6]}
trace: {cameras: [Camera], frames: 1-120, fps: 24, resolution: [320, 200], samples: 4}
)");
  EXPECT_EQ(job.scene, folder_.path() / "sub/a.glb");
  EXPECT_EQ(job.import.patch_area, 0.0025);
  EXPECT_EQ(job.import.time, 2.5);
  EXPECT_EQ(read(effective_job(job)).import.time, 2.5);
  ASSERT_EQ(job.materials.size(), 1u);
  EXPECT_EQ(job.materials[0].reflectance, Color(0.6f, 0.1f, 0.1f));
  EXPECT_EQ(job.solve.method, "matrix");
  EXPECT_EQ(job.lights.at("lights.lamp").scale, 2.0);
  EXPECT_EQ(job.trace.frames, "1-120");
}

TEST_F(JobFile, NamesAnUnknownKeyItsLineAndTheNearest) {
  EXPECT_ERROR(read("scene: a.glb\noutput: out\nsolve:\n  toleranse: 1\n"), ExitCode::bad_config,
               "unknown key `solve.toleranse` (" + (folder_ / "job.yaml").string() +
                   ", line 4): did you mean `solve.tolerance`?");
  EXPECT_ERROR(read("scene: a.glb\noutput: out\nsolver: {}\n"), ExitCode::bad_config, "line 3");
}

TEST_F(JobFile, NamesUnknownKeysBelowMaterialsAndLightsWithTheirLines) {
  EXPECT_ERROR(
      read("scene: a.glb\noutput: out\nmaterials:\n  red: {reflectance: [1, 0, 0]}\n  lamp:\n    emision: [1, 1, 1]\n"),
      ExitCode::bad_config,
      "unknown key `materials.lamp.emision` (" + (folder_ / "job.yaml").string() +
          ", line 6): did you mean `materials.lamp.emission`?");
  EXPECT_ERROR(read(std::string(kMinimal) + "lights:\n  l.a:\n    scale: -1\n"), ExitCode::bad_config, "line 5");
  EXPECT_ERROR(read(kMinimal, {"lights.\"l.a\".scael=2"}), ExitCode::bad_config,
               ", --set lights.\"l.a\".scael=2): did you mean `lights.\"l.a\".scale`?");
}

TEST_F(JobFile, RefusesAKeyThatStandsTwice) {
  EXPECT_ERROR(read("scene: a.glb\noutput: out\nsolve: {rays: 1}\nsolve: {rays: 2}\n"), ExitCode::bad_config, "line 4");
  EXPECT_ERROR(read("scene: a.glb\noutput: out\nsolve:\n  rays: 1\n  rays: 2\n"), ExitCode::bad_config,
               "the key `rays` stands twice");
  EXPECT_ERROR(read(std::string(kMinimal) + "lights:\n  a: {scale: 1}\n  a: {scale: 2}\n"), ExitCode::bad_config,
               "line 5");
}

TEST_F(JobFile, TakesKeysFromTheFilesThatItIncludes) {
  std::filesystem::create_directory(folder_ / "base");
  folder_.write("base/light.yaml", "lights: {a: {scale: 2}, b: {scale: 3}}\nsolve: {rays: 64, seed: 5}\n");
  folder_.write("base/scene.yaml", "include: light.yaml\nscene: a.glb\nsolve: {rays: 128}\n");
  const Job job = read("include: [base/scene.yaml]\noutput: out\nlights: {b: {scale: 4}}\n", {"solve.seed=6"});
  EXPECT_EQ(job.scene, folder_ / "base/a.glb") << "relative to the file that it stands in";
  EXPECT_EQ(job.output, folder_ / "out");
  EXPECT_EQ(job.solve.rays, 128);
  EXPECT_EQ(job.solve.seed, 6);
  EXPECT_EQ(job.lights.at("a").scale, 2);
  EXPECT_EQ(job.lights.at("b").scale, 4);
  EXPECT_EQ(effective_job(job).find("include"), std::string::npos);
}

TEST_F(JobFile, NamesTheIncludedFileThatIsWrongOrMissing) {
  folder_.write("base.yaml", "solve:\n  raise: 64\n");
  EXPECT_ERROR(read("include: base.yaml\n"), ExitCode::bad_config, "base.yaml, line 2");
  EXPECT_ERROR(read("scene: a.glb\ninclude: none.yaml\n"), ExitCode::missing_input, "job.yaml, line 2, include");
  EXPECT_ERROR(read("include: job.yaml\n"), ExitCode::bad_config, "does one include itself?");
  EXPECT_ERROR(read("include: {a: b}\n"), ExitCode::bad_config, "expected a path or a list of paths");
  EXPECT_ERROR(read(kMinimal, {"include=base.yaml"}), ExitCode::bad_config, "stands in job files alone");
}

TEST_F(JobFile, TellsFaultsOfTheFileFromThoseOfSets) {
  EXPECT_ERROR(read("scene: a.glb\noutput: out\nsolve:\n  rayz: 1\n", {"solve.rays=3"}), ExitCode::bad_config,
               "line 4");
  EXPECT_ERROR(read(std::string(kMinimal) + "solve:\n  rays: 1\n", {"solve.rayz=3"}), ExitCode::bad_config, "--set");
}

TEST_F(JobFile, SetsLeaveOtherAliasesAlone) {
  const Job job =
      read(std::string(kMinimal) + "lights: {a: &x {scale: 3, color: [1, 0, 0]}, b: *x}\n", {"lights.a.scale=5"});
  EXPECT_EQ(job.lights.at("a").scale, 5);
  EXPECT_EQ(job.lights.at("a").color, Color(1, 0, 0));
  EXPECT_EQ(job.lights.at("b").scale, 3);
}

TEST_F(JobFile, RefusesValuesThatAreNotAllowed) {
  EXPECT_ERROR(read(std::string(kMinimal) + "import: {patch_area: -1}"), ExitCode::bad_config, "import.patch_area");
  EXPECT_ERROR(read(std::string(kMinimal) + "import: {patch_area: .nan}"), ExitCode::bad_config, "patch_area");
  EXPECT_ERROR(read(std::string(kMinimal) + "solve: {method: magic}"), ExitCode::bad_config, "matrix or progressive");
  EXPECT_ERROR(read(std::string(kMinimal) + "solve: {rays: 2.5}"), ExitCode::bad_config, "whole number");
  EXPECT_ERROR(read(std::string(kMinimal) + "trace: {resolution: [0, 5]}"), ExitCode::bad_config, "resolution");
  EXPECT_ERROR(read(std::string(kMinimal) + "trace: {frames: 1-x}"), ExitCode::bad_config, "1-120");
  EXPECT_ERROR(read(std::string(kMinimal) + "trace: {layers: [direct, spekular]}"), ExitCode::bad_config, "specular");
  EXPECT_ERROR(read(std::string(kMinimal) + "trace: {layers: {depth: true}}"), ExitCode::bad_config, "list of layers");
  EXPECT_ERROR(read(std::string(kMinimal) + "trace: {pixel_type: double}"), ExitCode::bad_config, "half or float");
  EXPECT_ERROR(read(std::string(kMinimal) + "trace: {compression: jpeg}"), ExitCode::bad_config, "dwaa");
  EXPECT_ERROR(read(kMinimal, {"trace.frames=5-3"}), ExitCode::bad_config, "begins before it ends");
  EXPECT_ERROR(read(std::string(kMinimal) + "trace:\n  frames: 1,,2"), ExitCode::bad_config, "line 4");
  EXPECT_ERROR(read(std::string(kMinimal) + "materials: {a: {reflectance: [1, 2, 0]}}"), ExitCode::bad_config,
               "0 to 1");
  EXPECT_ERROR(read(std::string(kMinimal) + "materials: {a: {colour: 1}}"), ExitCode::bad_config, "colour");
  EXPECT_ERROR(read(std::string(kMinimal) + "solve: 3"), ExitCode::bad_config, "map");
  EXPECT_ERROR(read("output: out\n"), ExitCode::bad_config, "scene");
  EXPECT_ERROR(read("- a\n"), ExitCode::bad_config, "line 1");
  EXPECT_ERROR(read("a: [1\n"), ExitCode::bad_config, "not valid YAML");
}

TEST_F(JobFile, SurvivesHostileYaml) {
  EXPECT_ERROR(read(std::string(100000, '[')), ExitCode::bad_config, "YAML");
  EXPECT_ERROR(read("scene: &a [*a]\noutput: out\n"), ExitCode::bad_config, "scene");
  EXPECT_ERROR(read(std::string(2 << 20, ' ')), ExitCode::bad_config, "1 MiB");
  EXPECT_ERROR(read_job(folder_ / "none.yaml"), ExitCode::missing_input, "none.yaml");
}

TEST_F(JobFile, TakesPathsAsTheyStand) {
  const Job job = read("scene: link/../a.glb\noutput: link/../out\n");
  EXPECT_EQ(job.scene, folder_.path() / "link/../a.glb");
  EXPECT_EQ(job.output, folder_.path() / "link/../out");
  EXPECT_THAT(effective_job(job), ::testing::HasSubstr("scene: link/../a.glb"));
  EXPECT_THAT(effective_job(read("scene: /b/a.glb\noutput: out\n")), ::testing::HasSubstr("scene: /b/a.glb"));
}

TEST_F(JobFile, LimitsTheSizeOfFrames) {
  EXPECT_EQ(read(kMinimal, {"trace.resolution=[16384, 16384]"}).trace.resolution->at(0), 16384);
  EXPECT_ERROR(read(kMinimal, {"trace.resolution=[16384, 16385]"}), ExitCode::over_limit, "trace.resolution");
}

TEST_F(JobFile, IsOverriddenBySets) {
  const Job job = read(kMinimal, {"solve.rays=32", "lights.\"lights.lamp\".scale=2", "trace.cameras=[a, b]",
                                  R"(lights."an \"old\" \\ lamp".scale=4)", "solve={seed: 7}"});
  EXPECT_EQ(job.lights.at(R"(an "old" \ lamp)").scale, 4.0);
  EXPECT_EQ(job.solve.seed, 7);
  EXPECT_EQ(job.solve.rays, 32);
  EXPECT_EQ(job.lights.at("lights.lamp").scale, 2.0);
  EXPECT_EQ(job.trace.cameras, (std::vector<std::string>{"a", "b"}));
}

TEST_F(JobFile, TellsMalformedSetsFromUnknownKeys) {
  for (const char* set : {"solve.rays", "=3", "solve..rays=3", "solve.rays=[", "a.\"b=3", "solve.rays="})
    EXPECT_ERROR(read(kMinimal, {set}), ExitCode::usage, "--set");
  EXPECT_ERROR(read(kMinimal, {"solve.ray=3"}), ExitCode::bad_config, "did you mean `solve.rays`?");
  EXPECT_ERROR(read(kMinimal, {"solve.rays=-3"}), ExitCode::bad_config, "--set");
}

TEST_F(JobFile, EffectiveJobReadsBackAsTheSameJob) {
  const Job job = read(kMinimal, {"solve.rays=32", "lights.\"a.b\".color=[1, 0.5, 0]", "materials.x.mirror=[1,1,1]"});
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
}

}  // namespace
}  // namespace patchlight
