#include "pipeline/job/reader/job_reader.h"
#include "tests/pipeline/job/job_file.h"

namespace patchlight {
namespace {

using test::JobFile;
using test::kMinimal;

TEST_F(JobFile, ReadsHowSlurmIsToRunIt) {
  const Job job = read(std::string(kMinimal) +
                       "executor: slurm\nslurm: {shards: 16, cpus: 4, partition: 'a,b', time: 1-12, retries: 0, "
                       "options: [--mem=8G, --exclusive]}\n");
  EXPECT_EQ(job.executor, "slurm");
  EXPECT_EQ(job.slurm.shards, 16);
  EXPECT_EQ(job.slurm.cpus, 4);
  EXPECT_EQ(job.slurm.partition, "a,b");
  EXPECT_EQ(job.slurm.time, "1-12");
  EXPECT_EQ(job.slurm.retries, 0);
  EXPECT_EQ(job.slurm.options, (std::vector<std::string>{"--mem=8G", "--exclusive"}));
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
  EXPECT_EQ(effective_job(read(kMinimal)).find("slurm"), std::string::npos);
  for (const char* time : {"90", "1:30", "1:30:00", "2-12", "2-12:30", "2-12:30:15"})
    EXPECT_EQ(read(kMinimal, {std::string("slurm.time=") + time}).slurm.time, time);
  for (const char* bad :
       {"executor=cloud", "slurm.shards=0", "slurm.shards=1001", "slurm.cpus=1.5", "slurm.retries=-1",
        "slurm.partition=-p", "slurm.partition='a b'", "slurm.time=soon", "slurm.time=--wrap=x",
        "slurm.options=--mem=8G", "slurm.options=[mem=8G]", "slurm.options=['--mem 8G']", "slurm.options=[script.sh]"})
    EXPECT_ERROR(read(kMinimal, {bad}), ExitCode::bad_config, "bad value of `");
  EXPECT_ERROR(read(kMinimal, {"slurm.options=[--array=1-9]"}), ExitCode::bad_config, "--array, which Patchlight sets");
  EXPECT_ERROR(read(kMinimal, {"slurm.shard=2"}), ExitCode::bad_config, "did you mean `slurm.shards`?");
  EXPECT_ERROR(read(std::string(kMinimal) + "matrix: {executor: [local, slurm]}"), ExitCode::bad_config, "cannot vary");
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

TEST_F(JobFile, ReadsTheEnvironmentAndTheUnitsOfLights) {
  const std::string text = std::string(kMinimal) +
                           "import: {punctual_units: raw}\n"
                           "environment: {image: skies/dawn.hdr, color: [1, 2, 3], strength: 2, rotation: -90, "
                           "light_group: a/b}\n";
  const Job job = read(text);
  EXPECT_EQ(job.import.punctual_units, "raw");
  EXPECT_EQ(job.environment.image, folder_.path() / "skies/dawn.hdr");
  EXPECT_EQ(job.environment.color, Color(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(job.environment.strength, 2);
  EXPECT_EQ(job.environment.rotation, -90);
  EXPECT_EQ(job.environment.light_group, "a_b");
  EXPECT_NE(effective_job(job).find("image: skies/dawn.hdr"), std::string::npos);
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
  EXPECT_FALSE(read(kMinimal).environment.is_set());
  for (const char* fault : {"color: [1, 2]", "color: [1, 2, -3]", "strength: -1", "rotation: 400", "image: ''",
                            "light_group: ''", "sun: 1"})
    EXPECT_ERROR(read(std::string(kMinimal) + "environment: {" + fault + "}\n"), ExitCode::bad_config, "environment");
  EXPECT_ERROR(read(std::string(kMinimal) + "import: {punctual_units: watts}\n"), ExitCode::bad_config,
               "blender or si");
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
  EXPECT_FALSE(corner.up);
  EXPECT_EQ(corner.angle, 55);
  EXPECT_EQ(corner.turntable, 48);
  EXPECT_EQ(plan.height, 4);
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
}

TEST_F(JobFile, RefusesCamerasThatLookNowhere) {
  const auto cameras = [&](const std::string& text) { return read(std::string(kMinimal) + "cameras:\n  " + text); };
  EXPECT_ERROR(
      cameras("a: {look_from: [0, 0, 1]}\n  b: {turntable: 30}"), ExitCode::bad_config,
      "`cameras.b` that do not go together (" + (folder_ / "job.yaml").string() + ", line 5): give `look_from`");
  EXPECT_ERROR(cameras("a: {look_from: [0, 5, 0]}"), ExitCode::bad_config, "`up` across");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, 5], up: [0, 0, 0]}"), ExitCode::bad_config, "`up` across");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, 5], angle: 40, height: 2}"), ExitCode::bad_config, "parallel");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, 5], angle: 180}"), ExitCode::bad_config, "0.01 to 179");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0, .nan]}"), ExitCode::bad_config, "`cameras.a.look_from`");
  EXPECT_ERROR(cameras("a: {look_from: [0, 0]}"), ExitCode::bad_config, "[x, y, z]");
  EXPECT_ERROR(cameras("a: {look_form: [0, 0, 1]}"), ExitCode::bad_config, "did you mean `cameras.a.look_from`?");
  EXPECT_ERROR(cameras("'': {look_from: [0, 0, 1]}"), ExitCode::bad_config, "name");
  EXPECT_ERROR(read(kMinimal, {"cameras.a.turntable=30"}), ExitCode::bad_config, "--set");
}

TEST_F(JobFile, ReadsTheLensOfACamera) {
  const Job job = read(std::string(kMinimal) + R"(
cameras:
  Camera: {shift: [0.1, -0.25], aspect: 1.5, znear: 0.5, zfar: 80, aperture: 0.02, focus: 3}
)",
                       {"cameras.Camera.focus=4", "cameras.Other.angle=30"});
  const CameraConfig& camera = job.cameras.at("Camera");
  EXPECT_FALSE(camera.has_pose());
  EXPECT_EQ(camera.shift, Vec2d(0.1, -0.25));
  EXPECT_EQ(camera.aspect, 1.5);
  EXPECT_EQ(camera.znear, 0.5);
  EXPECT_EQ(camera.zfar, 80);
  EXPECT_EQ(camera.aperture, 0.02);
  EXPECT_EQ(camera.focus, 4);
  EXPECT_EQ(job.cameras.at("Other").angle, 30);
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
}

TEST_F(JobFile, RefusesALensThatCannotBe) {
  const auto camera = [&](const std::string& text) {
    return read(std::string(kMinimal) + "cameras:\n  a: {angle: 9}\n  b:\n    " + text);
  };
  for (const auto& [fault, expected] : {std::pair("shift: 0.1", "two numbers"),
                                        {"shift: [0.1, .inf]", "number from"},
                                        {"aspect: 0", "number from"},
                                        {"znear: -1", "number from"},
                                        {"zfar: 0", "number from"},
                                        {"aperture: -0.1", "number from"},
                                        {"aperture: .nan", "number from"},
                                        {"focus: 0", "number from"}}) {
    EXPECT_ERROR(camera(fault), ExitCode::bad_config, expected);
    EXPECT_ERROR(camera(fault), ExitCode::bad_config, "line 6");
  }
  EXPECT_ERROR(camera("znear: 2\n    zfar: 2"), ExitCode::bad_config, "`zfar` above `znear`");
  EXPECT_ERROR(camera("znear: 2\n    zfar: 2"), ExitCode::bad_config, "line 5");
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

TEST_F(JobFile, KnowsLightGroupsByTheNamesThatFilesGiveThem) {
  const Job job = read(std::string(kMinimal) + "lights: {hall/lamp: {scale: 2}, .: {scale: 3}, ..: {scale: 4}}\n");
  EXPECT_EQ(job.lights.at("hall_lamp").scale, 2);
  EXPECT_EQ(job.lights.at("_").scale, 3);
  EXPECT_EQ(job.lights.at("..").scale, 4);
}

TEST_F(JobFile, ReadsLightsThatChangeWithTheFrame) {
  const std::string lights = "lights: {a: {scale: {5: 1, 9: 3}, color: {0: [1, 0, 0], 2: [0, 1, 0]}}, b: {scale: 2}}\n";
  const Job read_once = read(std::string(kMinimal) + lights);
  for (const Job& job : {read_once, parse_effective_job(effective_job(read_once))}) {
    const LightSetting &a = job.lights.at("a"), &b = job.lights.at("b");
    EXPECT_TRUE(a.is_animated());
    for (const auto& [frame, scale] : {std::pair(0, 1.0), {5, 1.0}, {6, 1.5}, {8, 2.5}, {9, 3.0}, {100, 3.0}})
      EXPECT_DOUBLE_EQ(a.scale.at(frame), scale) << frame;
    EXPECT_EQ(a.color.at(1), Color(0.5f, 0.5f, 0));
    EXPECT_FALSE(b.is_animated());
    EXPECT_EQ(b.scale.at(7), 2);
  }
  EXPECT_EQ(read(std::string(kMinimal) + lights, {"lights.a.scale=4"}).lights.at("a").scale.at(6), 4);
  for (const auto& [value, problem] : {std::pair("{}", "expected a value, or values by frame"),
                                       {"{x: 1}", "expected a whole number"},
                                       {"{-1: 1}", "expected a whole number"},
                                       {"{1: -1}", "expected a number"},
                                       {"{1: 2, 01: 3}", "comes again"}})
    EXPECT_ERROR(read(std::string(kMinimal) + "lights: {a: {scale: " + value + "}}\n"), ExitCode::bad_config, problem);
}

TEST_F(JobFile, ReadsSizesAndPhotometricFilesOfLights) {
  std::filesystem::create_directory(folder_ / "base");
  folder_.write("base/light.yaml", "lights: {lamp: {ies: down.ldt}}\n");
  const Job job = read("include: base/light.yaml\n" + std::string(kMinimal) +
                           "lights: {bulb: {ies: lamps/down.ies, radius: 0.1}, sun: {angle: 0.53}}\n",
                       {"lights.spot.ies=a.ies"});
  EXPECT_EQ(job.lights.at("bulb").radius, 0.1);
  EXPECT_EQ(job.lights.at("bulb").angle, std::nullopt);
  EXPECT_EQ(job.lights.at("sun").angle, 0.53);
  EXPECT_EQ(job.lights.at("bulb").ies, folder_ / "lamps/down.ies") << "relative to its job file";
  EXPECT_EQ(job.lights.at("lamp").ies, folder_ / "base/down.ldt");
  EXPECT_EQ(job.lights.at("spot").ies, folder_ / "a.ies");
  EXPECT_THAT(effective_job(job), ::testing::HasSubstr("ies: lamps/down.ies"));
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
  EXPECT_EQ(effective_job(read(std::string(kMinimal) + "lights: {a: {scale: 2}}\n")).find("radius"), std::string::npos);
  for (const char* bad : {"radius: -1", "radius: 1e7", "angle: 181", "angle: wide", "ies: [a]"})
    EXPECT_ERROR(read(std::string(kMinimal) + "lights: {a: {" + bad + "}}\n"), ExitCode::bad_config, "expected");
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

}  // namespace
}  // namespace patchlight
