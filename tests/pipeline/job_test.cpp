#include "pipeline/files/job.h"

#include <gtest/gtest.h>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::TemporaryFolder;

class JobFile : public ::testing::Test {
 protected:
  Job read(const std::string& text, const std::vector<std::string>& sets = {}) {
    return read_job(folder_.write("job.yaml", text), sets);
  }
  TemporaryFolder folder_;
};

constexpr const char* kMinimal = "scene: a.glb\noutput: out\n";

TEST_F(JobFile, GivesDefaultsToAbsentKeys) {
  const Job job = read(kMinimal);
  EXPECT_FALSE(job.import.patch_area);
  EXPECT_EQ(job.solve.rays, 256);
  EXPECT_EQ(job.trace.resolution, (std::array<int, 2>{640, 480}));
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

TEST_F(JobFile, ReadsEveryOverrideOfMaterialsAndNodes) {
  const std::string overrides =
      "{reflectance: [0.1, 0.2, 0.3], emission: [1, 2, 3], mirror: [0, 0, 0.5], light_group: a/b, patch_area: 0.01, "
      "exclude: true}";
  const std::string text = std::string(kMinimal) + "materials: {x: " + overrides + "}\nnodes: {y: " + overrides + "}\n";
  const Job job = read(text);
  for (const auto* list : {&job.materials, &job.nodes}) {
    ASSERT_EQ(list->size(), 1u);
    const MaterialOverride& change = list->front();
    EXPECT_EQ(change.reflectance, Color(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(change.emission, Color(1, 2, 3));
    EXPECT_EQ(change.mirror, Color(0, 0, 0.5f));
    EXPECT_EQ(change.light_group, "a_b");
    EXPECT_EQ(change.patch_area, 0.01);
    EXPECT_EQ(change.exclude, true);
  }
  EXPECT_EQ(job.nodes[0].pattern, "y");
  EXPECT_EQ(read(effective_job(job)).nodes[0].patch_area, 0.01);
  EXPECT_EQ(read(kMinimal, {"nodes.lamp_*.exclude=true"}).nodes.at(0).exclude, true);
  EXPECT_ERROR(read(std::string(kMinimal) + "nodes: {y: {patch_area: 0}}"), ExitCode::bad_config, "nodes.y.patch_area");
  EXPECT_ERROR(read(std::string(kMinimal) + "nodes: {y: {light_group: ''}}"), ExitCode::bad_config, "1 to 1024 bytes");
}

TEST_F(JobFile, ReadsCamerasOfItsOwn) {
  const Job job = read(std::string(kMinimal) + R"(
cameras:
  corner: {look_from: [1, 2, 3], look_at: [0, 1, 0], angle: 55}
  plan: {look_from: [0, 9, 0], up: [0, 0, -1], height: 4}
)",
                       {"cameras.corner.turntable=48"});
  ASSERT_EQ(job.cameras.size(), 2u);
  const CameraConfig &corner = job.cameras.at("corner"), &plan = job.cameras.at("plan");
  EXPECT_EQ(corner.look_from, Vec3d(1, 2, 3));
  EXPECT_EQ(corner.look_at, Vec3d(0, 1, 0));
  EXPECT_EQ(corner.up, Vec3d(0, 1, 0));
  EXPECT_EQ(corner.angle, 55);
  EXPECT_EQ(corner.turntable, 48);
  EXPECT_EQ(plan.height, 4);
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
}

TEST_F(JobFile, RefusesCamerasThatLookNowhere) {
  const auto cameras = [&](const std::string& text) { return read(std::string(kMinimal) + "cameras:\n  " + text); };
  EXPECT_ERROR(
      cameras("a: {look_from: [0, 0, 1]}\n  b: {angle: 30}"), ExitCode::bad_config,
      "`cameras.b` that do not go together (" + (folder_ / "job.yaml").string() + ", line 5): give `look_from`");
  EXPECT_ERROR(cameras("a: {look_from: [0, 5, 0]}"), ExitCode::bad_config, "`up` across");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, 5], up: [0, 0, 0]}"), ExitCode::bad_config, "`up` across");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, 5], angle: 40, height: 2}"), ExitCode::bad_config, "parallel");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, 5], angle: 180}"), ExitCode::bad_config, "0.01 to 179");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, .nan]}"), ExitCode::bad_config, "`cameras.a.look_from`");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0]}"), ExitCode::bad_config, "[x, y, z]");
  EXPECT_ERROR(cameras("a: {look_form: [0, 0, 1]}"), ExitCode::bad_config, "did you mean `cameras.a.look_from`?");
  EXPECT_ERROR(cameras("'': {look_from: [0, 0, 1]}"), ExitCode::bad_config, "name");
  EXPECT_ERROR(read(kMinimal, {"cameras.a.angle=30"}), ExitCode::bad_config, "--set");
}

TEST_F(JobFile, ReadsFramesAsTextOrList) {
  EXPECT_EQ(read(kMinimal, {"trace.frames=1,5..9"}).trace.frames, "1,5..9");
  EXPECT_EQ(read(kMinimal, {"trace.frames=7"}).trace.frames, "7");
  EXPECT_EQ(read(kMinimal, {"trace.frames=[1, 5-9, 20..40:2]"}).trace.frames, "1, 5-9, 20..40:2");
}

TEST_F(JobFile, TakesLayersInAnyOrder) {
  const Job job = read(std::string(kMinimal) + "trace: {layers: [depth, direct, depth]}");
  EXPECT_EQ(job.trace.layers, (std::vector<std::string>{"direct", "depth"}));
  EXPECT_EQ(read(kMinimal, {"trace.layers=[depth, direct]"}).trace.layers, job.trace.layers);
  EXPECT_EQ(read(kMinimal, {"trace.layers=patch"}).trace.layers, std::vector<std::string>{"patch"});
  EXPECT_TRUE(read(kMinimal).trace.layers.empty());
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

TEST_F(JobFile, ReadsSizesOfTheCache) {
  EXPECT_EQ(read(kMinimal).cache, 10ull << 30);
  for (const auto& [text, bytes] : {std::pair("0", 0ull),
                                    {"12", 12ull},
                                    {"1.5KiB", 1536ull},
                                    {"2M", 2ull << 20},
                                    {"3 GB", 3ull << 30},
                                    {"1TiB", 1ull << 40}}) {
    const Job job = read(std::string(kMinimal) + "cache: " + text + "\n");
    EXPECT_EQ(job.cache, bytes) << text;
    EXPECT_EQ(parse_effective_job(effective_job(job)).cache, bytes) << text;
  }
  for (const char* text : {"-1", "much", "1PiB", "[1]", "999999999999T"})
    EXPECT_ERROR(read(std::string(kMinimal) + "cache: " + text + "\n"), ExitCode::bad_config, "expected a size");
}

TEST_F(JobFile, ReadsAMatrixOfVariants) {
  const Job job = read(std::string(kMinimal) +
                       "matrix: {solve.rays: [64, 128], mood: {day: {}, night: {lights.\"a.b\".scale: 0}}}\n");
  ASSERT_EQ(job.matrix.size(), 2u);
  EXPECT_EQ(job.matrix[0].choices[1].name, "128");
  EXPECT_EQ(job.matrix[0].choices[1].settings[0], std::pair(std::string("solve.rays"), std::string("128")));
  EXPECT_EQ(job.matrix[1].choices[0].settings.size(), 0u);
  EXPECT_EQ(job.matrix[1].choices[1].settings[0], std::pair(std::string("lights.\"a.b\".scale"), std::string("0")));
  std::string many = std::string(kMinimal) + "matrix: {";
  for (const char* key : {"solve.rays", "solve.seed", "solve.max_shots", "trace.samples", "trace.fps"})
    many += std::string(key) + ": [1, 2, 3, 4, 5, 6, 7, 8], ";
  EXPECT_ERROR(read(many + "}\n"), ExitCode::bad_config, "at most 10000 combinations");
}

TEST_F(JobFile, KnowsLightGroupsByTheNamesThatFilesGiveThem) {
  const Job job = read(std::string(kMinimal) + "lights: {hall/lamp: {scale: 2}, .: {scale: 3}, ..: {scale: 4}}\n");
  EXPECT_EQ(job.lights.at("hall_lamp").scale, 2);
  EXPECT_EQ(job.lights.at("_").scale, 3);
  EXPECT_EQ(job.lights.at("..").scale, 4);
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

TEST_F(JobFile, ReadsShaders) {
  const Job job = read(std::string(kMinimal) + R"(
shaders:
  wall_*: {reflectance: ["(1+cos(4*pi*u))/2", v, 1]}
  lamp: {emission: "u > 0.5 ? 5 : 0", reflectance: 0.5}
)");
  ASSERT_EQ(job.shaders.size(), 2u);
  EXPECT_EQ(job.shaders[0].name, "wall_*");
  EXPECT_EQ(job.shaders[0].reflectance, (ColorExpressions{"(1+cos(4*pi*u))/2", "v", "1"}));
  EXPECT_FALSE(is_set(job.shaders[0].emission));
  EXPECT_EQ(job.shaders[1].emission[2], "u > 0.5 ? 5 : 0");
  EXPECT_EQ(job.shaders[1].reflectance[0], "0.5");
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
}

TEST_F(JobFile, RefusesShadersOfAnotherShape) {
  const auto shaders = [&](const std::string& text) { return read(kMinimal + ("shaders: " + text)); };
  EXPECT_ERROR(shaders("{a: {reflectance: [u, v]}}"), ExitCode::bad_config, "three expressions");
  EXPECT_ERROR(shaders("{a: {reflectance: [u, v, [1]]}}"), ExitCode::bad_config, "expected an expression");
  EXPECT_ERROR(shaders("{a: {reflectance: ''}}"), ExitCode::bad_config, "expected an expression");
  EXPECT_ERROR(shaders("{a: {mirror: u}}"), ExitCode::bad_config, "unknown key `mirror` of `a`");
  EXPECT_ERROR(shaders("{a: u}"), ExitCode::bad_config, "map of settings");
  EXPECT_ERROR(shaders("[u]"), ExitCode::bad_config, "`shaders`");
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
  EXPECT_EQ(read(kMinimal, {"trace.resolution=[16384, 16384]"}).trace.resolution[0], 16384);
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

TEST_F(JobFile, ReadsASweepOfAnyKeys) {
  const Job job = read(std::string(kMinimal) + R"(
bench:
  sweep:
    - {solve.rays: [16, 64], import.patch_area: [1e-3, 4e-4]}
    - {trace.resolution: [[8, 8], [16, 16]], lights."lights.lamp".scale: 2}
  reference: truth.exr
  reference_settings: {solve.rays: 99}
)");
  ASSERT_EQ(job.bench.sweep.size(), 2u);
  EXPECT_EQ(job.bench.sweep[0][1].key, "import.patch_area");
  EXPECT_EQ(job.bench.sweep[0][1].values, (std::vector<std::string>{"1e-3", "4e-4"}));
  EXPECT_EQ(job.bench.sweep[1][0].values, (std::vector<std::string>{"[8, 8]", "[16, 16]"}));
  EXPECT_EQ(job.bench.sweep[1][1].key, "lights.\"lights.lamp\".scale");
  EXPECT_EQ(job.bench.reference, folder_ / "truth.exr");
  EXPECT_EQ(job.bench.reference_settings.at("solve.rays"), "99");
  EXPECT_EQ(job.bench.reference_settings.at("trace.samples"), "64");
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
  EXPECT_EQ(read(kMinimal, {"bench.sweep={solve.rays: [1]}"}).bench.sweep[0][0].values[0], "1");
}

TEST_F(JobFile, NamesTheLineOfABadSweptKeyOrValue) {
  const auto bench = [&](const std::string& text) { return read(std::string(kMinimal) + "bench:\n" + text); };
  EXPECT_ERROR(bench("  sweep:\n    - {solve.rays: [1]}\n    - {solve.ray: [1]}\n"), ExitCode::bad_config,
               "line 6): did you mean `solve.rays`?");
  EXPECT_ERROR(bench("  sweep:\n    solve.tolerance: [0.1]\n    solve.rays: [64, few]\n"), ExitCode::bad_config,
               "line 6): expected a whole number");
  EXPECT_ERROR(bench("  sweep: [{output: [a, b]}]\n"), ExitCode::bad_config, "`output` cannot vary");
  EXPECT_ERROR(bench("  sweep: [{solve..rays: 1}]\n"), ExitCode::bad_config, "line 4");
  EXPECT_ERROR(bench("  sweep: [{solve.rays: []}]\n"), ExitCode::bad_config, "at least one value");
  EXPECT_ERROR(bench("  sweep: 3\n"), ExitCode::bad_config, "line 4");
  EXPECT_ERROR(bench("  reference_settings: {solve.speed: 1}\n"), ExitCode::bad_config, "unknown key `solve.speed`");
  EXPECT_ERROR(bench("  reference: {radiance: [1, 2]}\n"), ExitCode::bad_config, "radiance");
  EXPECT_ERROR(bench("  repeats: 0\n"), ExitCode::bad_config, "bench.repeats");
  EXPECT_ERROR(bench("  swep: []\n"), ExitCode::bad_config, "did you mean `bench.sweep`?");
  EXPECT_ERROR(read(kMinimal, {"bench.sweep={solve.rays: [0]}"}), ExitCode::bad_config, "--set");
}

TEST_F(JobFile, EffectiveJobReadsBackAsTheSameJob) {
  const Job job = read(kMinimal, {"solve.rays=32", "lights.\"a.b\".color=[1, 0.5, 0]", "materials.x.mirror=[1,1,1]"});
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
}

}  // namespace
}  // namespace patchlight
