#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "pipeline/frames/frame_list.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/job/stage_keys.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

/// One setting of a job and the keys that it enters: those of its stages' outputs, and of what stands in transport.h5.
struct Setting {
  std::string key;    ///< As --set takes it.
  std::string value;  ///< Another than its default.
  std::string enters;
  std::string beside{};  ///< A setting without which it is not read.
};

// A solve that runs again makes other frames too; that is not told here.
const std::vector<Setting> kSettings{
    {"scene", "b.glb", ""},  // what is in it counts, not where it stands
    {"output", "other", ""},
    {"import.patch_area", "0.5", "import"},
    {"import.accuracy", "2", "import"},
    {"import.accuracy", "2", "", "import.patch_area=0.5"},
    {"import.max_patches", "100", ""},
    {"import.time", "1", "import"},
    {"import.punctual_units", "raw", "import"},
    {"import.dielectric_coat", "false", "import"},
    {"environment.color", "[1, 1, 1]", "import"},
    {"environment.image", "sky.hdr", "import"},
    {"environment.strength", "2", ""},
    {"environment.strength", "2", "import", "environment.image=sky.hdr"},
    {"environment.rotation", "90", "import", "environment.image=sky.hdr"},
    {"environment.light_group", "sky", "import", "environment.image=sky.hdr"},
    {"materials.a.reflectance", "[0, 0, 0]", "import"},
    {"nodes.a.exclude", "true", "import"},
    {"shaders.a.reflectance", "u", "import"},
    {"solve.method", "progressive", "solve"},
    {"solve.form_factors", "hemicube", "transport solve"},
    {"solve.rays", "100", "transport solve"},
    {"solve.display", "false", "solve"},
    {"solve.hemicube_resolution", "64", ""},
    {"solve.hemicube_resolution", "64", "transport solve", "solve.form_factors=hemicube"},
    {"solve.tolerance", "0.1", "solve"},
    {"solve.error_target", "0.1", "transport solve"},
    {"solve.max_shots", "10", ""},
    {"solve.max_shots", "10", "solve", "solve.method=progressive"},
    {"solve.seed", "2", "transport solve"},
    {"lights.lamp.scale", "2", "trace"},
    {"lights.lamp.color", "[1, 0.5, 0]", "trace"},
    {"lights.lamp.radius", "0.1", "import"},
    {"lights.lamp.angle", "1", "import"},
    {"lights.lamp.ies", "down.ies", "import"},
    {"cameras.a.angle", "50", "trace"},
    {"cameras.a.shift", "[0.1, 0]", "trace"},
    {"cameras.a.shift", "[0, 0.1]", "trace"},
    {"cameras.a.aspect", "2", "trace"},
    {"cameras.a.aspect", "2", "", "trace.resolution=[8, 8]"},
    {"cameras.a.znear", "0.1", "trace"},
    {"cameras.a.zfar", "10", "trace"},
    {"cameras.a.aperture", "0.1", "trace"},
    {"cameras.a.focus", "2", ""},  // without an aperture all is sharp
    {"cameras.a.focus", "2", "trace", "cameras.a.aperture=0.1"},
    {"cameras.moving.shift", "[0.1, 0]", "trace", "trace.cameras=[moving]"},
    {"cameras.b.look_from", "[1, 1, 1]", ""},  // a camera that is not asked for
    {"trace.cameras", "[b]", "trace"},
    {"trace.frames", "2", "trace"},
    {"trace.fps", "12", ""},
    {"trace.fps", "12", "trace", "trace.cameras=[moving]"},
    {"trace.resolution", "[8, 8]", "trace"},
    {"trace.quality", "gather", "trace"},
    {"trace.gather_rays", "16", ""},
    {"trace.gather_rays", "16", "trace", "trace.quality=gather"},
    {"trace.samples", "4", "trace"},
    {"trace.cull_backfaces", "true", "trace"},
    {"trace.layers", "[depth]", "trace"},
    {"trace.pixel_type", "float", "trace"},
    {"trace.compression", "piz", "trace"},
    {"trace.view", "Raw", "trace"},
    {"trace.ocio", "x.ocio", ""},  // its content counts: view_config_key()
    {"trace.look", "High", "trace"},
    {"trace.exposure", "1", "trace"},
    {"trace.gamma", "2", "trace"},
    {"cache", "1GiB", ""},
    {"matrix.mood", "{day: {trace.samples: 1}}", ""},
    {"executor", "slurm", ""},
    {"slurm.shards", "2", ""},
    {"slurm.cpus", "2", ""},
    {"slurm.partition", "a", ""},
    {"slurm.time", "60", ""},
    {"slurm.options", "[--mem=1G]", ""},
    {"slurm.retries", "0", ""},
    {"bench.sweep", "{solve.rays: [1]}", ""},
    {"bench.reference", "a.exr", ""},
    {"bench.reference_settings", "{solve.rays: 1}", ""},
    {"bench.camera", "b", ""},
    {"bench.repeats", "2", ""},
};

class StageKeys : public ::testing::Test {
 protected:
  StageKeys() {
    folder_.write("job.yaml",
                  "scene: a.glb\noutput: out\n"
                  "cameras:\n  a: {look_from: [0, 0, 5], turntable: 8}\n  b: {look_from: [0, 5, 5]}\n"
                  "trace: {cameras: [a]}\n");
    scene_.light_groups = {"lamp"};
    Camera& moving = scene_.cameras.emplace_back();
    moving.name = "moving";
    moving.motion = {{Motion::Kind::translation, Motion::Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0}}};
  }

  /// What a job's outputs carry, by the word for it.
  std::map<std::string, std::string> keys(const std::vector<std::string>& sets) {
    const Job job = read_job(folder_ / "job.yaml", sets);
    std::string frames;
    for (const Frame& frame : job_frames(job, scene_))
      frames += frame_key(scene_, "solution", job, frame.camera, frame.number, "config");
    return {{"import", import_inputs_key({{"a.glb", "hash"}}, job)},
            {"transport", transport_key("geometry", job.solve)},
            {"solve", energy_key("patches", job.solve)},
            {"trace", frames}};
  }

  test::TemporaryFolder folder_;
  PatchSet scene_;
};

TEST_F(StageKeys, HoldWhatCanChangeTheStageAndNothingElse) {
  for (const Setting& setting : kSettings) {
    std::vector<std::string> sets;
    if (!setting.beside.empty()) sets.push_back(setting.beside);
    const auto before = keys(sets);
    sets.push_back(setting.key + "=" + setting.value);
    const auto after = keys(sets);
    std::string changed;
    for (const char* stage : {"import", "transport", "solve", "trace"})
      if (before.at(stage) != after.at(stage)) changed += (changed.empty() ? "" : " ") + std::string(stage);
    EXPECT_EQ(changed, setting.enters) << setting.key << " " << setting.beside;
  }
}

TEST_F(StageKeys, AreToldHereForEverySettingOfAJob) {
  std::set<std::string> reported{"include"};
  for (const Setting& setting : kSettings) {
    reported.insert(setting.key);
    for (const char* names : {"materials", "nodes", "shaders", "lights", "cameras", "matrix"})
      if (setting.key.starts_with(std::string(names) + ".")) reported.insert(names);
  }
  const std::string help = job_key_help();
  static const std::regex line("\n  ([a-z_.]+)");
  for (std::sregex_iterator i(help.begin(), help.end(), line), end; i != end; ++i)
    EXPECT_TRUE(reported.contains((*i)[1])) << "say in kSettings which stages run again after a change of " << (*i)[1];
}

}  // namespace
}  // namespace patchlight
