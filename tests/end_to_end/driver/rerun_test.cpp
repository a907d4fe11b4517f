#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>
#include <regex>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/image/image_file.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/job/view_config.h"
#include "pipeline/system/content_hash.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

class Rerun : public ProgramTest {
 protected:
  void SetUp() override {
    small_job(folder_);
    const Outcome first = run({});
    ASSERT_EQ(first.code, 0) << first.err;
    ASSERT_EQ(stages(first), "import solve trace");
  }

  Outcome run(std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "job.yaml"});
    return run_program(folder_, "patchlight", more);
  }

  /// The stages that ran or were restored, in order.
  static std::string stages(const Outcome& outcome) {
    std::string names;
    static const std::regex ran("patchlight-run: (?:warning: )?(import|solve|trace) (?:runs|restored)");
    for (std::sregex_iterator i(outcome.err.begin(), outcome.err.end(), ran), end; i != end; ++i)
      names += (names.empty() ? "" : " ") + (*i)[1].str();
    return names;
  }
};

TEST_F(Rerun, WritesAFrameAsExrAndPng) {
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/frames/camera.0001.exr"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/frames/camera.0001.png"));
}

TEST_F(Rerun, SkipsEverythingWhenNothingChanged) {
  const Outcome again = run({});
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(stages(again), "");
  EXPECT_THAT(again.err, HasSubstr("trace skipped: up to date"));
}

TEST_F(Rerun, RunsOnlyTheTraceForAnotherViewOfTheSameSolution) {
  EXPECT_EQ(stages(run({"--set", "trace.resolution=[16, 16]"})), "trace");
  EXPECT_EQ(stages(run({"--set", "lights.\"lights.ceiling\".scale=2"})), "trace");
  EXPECT_EQ(stages(run({"--set", "lights.\"lights.ceiling\".color=[1, 0.5, 0.2]"})), "trace");
  const std::string camera = "cameras.mine={look_from: [0, 0.28, 1.2], look_at: [0, 0.28, 0]}";
  EXPECT_EQ(stages(run({"--set", camera})), "trace");
  EXPECT_EQ(stages(run({"--set", camera, "--set", "cameras.mine.angle=50"})), "trace");
  EXPECT_EQ(stages(run({"--set", "trace.view=ACES"})), "trace");
}

TEST_F(Rerun, SolvesAgainForMoreRays) {
  EXPECT_EQ(stages(run({"--set", "solve.rays=80"})), "solve trace");
}

TEST_F(Rerun, RunsEverythingForAnotherPatchArea) {
  EXPECT_EQ(stages(run({"--set", "import.patch_area=0.02"})), "import solve trace");
}

TEST_F(Rerun, DoesNotSolveAgainWhenOnlyTheCameraChanged) {
  std::string glb = read_text(folder_ / "box.glb");
  const std::size_t at = glb.find("\"yfov\":0.6");
  ASSERT_NE(at, std::string::npos);
  glb[at + 9] = '7';  // keeps the length of the JSON
  folder_.write("box.glb", glb);
  EXPECT_EQ(stages(run({})), "import trace");
}

TEST_F(Rerun, SolvesAgainForAShaderThatChangesPatches) {
  const auto with = [&](const std::string& expression) {
    return stages(run({"--set", "shaders.\"*\".reflectance=" + expression}));
  };
  EXPECT_EQ(with("0.3 + x*0"), "import solve trace");
  EXPECT_EQ(with("0.3 + x*0"), "");
  EXPECT_EQ(with("0.3 + y*0"), "import trace");
  EXPECT_EQ(stages(run({})), "import solve trace");
}

TEST_F(Rerun, CastsNoRayForOtherColoursOrEmission) {
  const auto cast = [&] { return run_program(folder_, "patchlight", {"info", "out/energy.h5"}).out; };
  EXPECT_THAT(cast(), Not(HasSubstr(" 0 rays")));
  EXPECT_EQ(stages(run({"--set", "materials.red.reflectance=[0.5, 0.1, 0.1]"})), "import solve trace");
  EXPECT_THAT(cast(), HasSubstr(" 0 rays"));
  EXPECT_EQ(stages(run({"--set", "materials.light.emission=[30, 20, 10]"})), "import solve trace");
  EXPECT_THAT(cast(), HasSubstr(" 0 rays"));
  EXPECT_EQ(stages(run({"--set", "nodes.*wall.reflectance=[0.2, 0.3, 0.4]"})), "import solve trace");
  EXPECT_THAT(cast(), HasSubstr(" 0 rays"));
  EXPECT_EQ(stages(run({"--set", "materials.red.mirror=[0.5, 0.5, 0.5]"})), "import solve trace");
  EXPECT_THAT(cast(), Not(HasSubstr(" 0 rays"))) << "a mirror changes the rays";
}

TEST_F(Rerun, CastsNoRayForAnotherEnvironmentImage) {
  const auto cast = [&] { return run_program(folder_, "patchlight", {"info", "out/energy.h5"}).out; };
  const auto write_sky = [&](float left) { write_exr(folder_ / "sky.exr", {2, 1, {Color(left), Color(1.0f)}, {}}); };
  const std::string image = "environment.image=sky.exr";
  write_sky(0.5f);
  EXPECT_EQ(stages(run({"--set", image})), "import solve trace");
  EXPECT_THAT(cast(), Not(HasSubstr(" 0 rays")));
  EXPECT_THAT(cast(), HasSubstr("environment"));
  EXPECT_EQ(stages(run({"--set", "environment.image=./sky.exr"})), "");
  write_sky(2.0f);
  EXPECT_THAT(run_program(folder_, "patchlight", {"status", "job.yaml", "--set", image}).out, HasSubstr("sky.exr"));
  EXPECT_EQ(stages(run({"--set", image})), "import solve trace");
  EXPECT_THAT(cast(), HasSubstr(" 0 rays"));
  const std::string turned = "environment.rotation=90";
  const Outcome status = run_program(folder_, "patchlight", {"status", "job.yaml", "--set", image, "--set", turned});
  EXPECT_THAT(status.out, HasSubstr("patches.h5  environment.rotation 0 -> 90\n"));
  EXPECT_EQ(stages(run({"--set", image, "--set", turned})), "import solve trace");
  EXPECT_THAT(cast(), HasSubstr(" 0 rays"));
  EXPECT_EQ(stages(run({})), "import solve trace") << "without an environment";
}

TEST_F(Rerun, DoesNothingForATouchedFileACommentAnotherSpellingOrAnUnrelatedKey) {
  folder_.write("box.glb", read_text(folder_ / "box.glb"));
  const auto later = std::filesystem::file_time_type::clock::now() + std::chrono::hours(1);
  for (const char* file : {"job.yaml", "box.glb", "out/patches.h5", "out/energy.h5", "out/frames/camera.0001.exr"})
    std::filesystem::last_write_time(folder_ / file, later);
  EXPECT_EQ(stages(run({})), "");
  std::string job = "# a comment\n" + read_text(folder_ / "job.yaml");
  folder_.write("job.yaml", job);
  EXPECT_EQ(stages(run({})), "");
  folder_.write("job.yaml",
                job.replace(job.find("box.glb"), 7, "./../" + folder_.path().filename().string() + "/box.glb"));
  EXPECT_EQ(stages(run({})), "");
  EXPECT_EQ(stages(run({"--set", "solve.hemicube_resolution=64", "--set", "bench.repeats=3", "--set", "cache=1GiB"})),
            "");
}

TEST_F(Rerun, WritesKeyAndEffectiveJobIntoEveryOutput) {
  const Job job = read_job(folder_ / "job.yaml");
  const PatchSet scene = read_patches(folder_ / "out/patches.h5");
  const EnergyField energy = read_energy(folder_ / "out/energy.h5");
  Image frame = read_exr_header(folder_ / "out/frames/camera.0001.exr");
  EXPECT_EQ(scene.inputs_key, import_inputs_key(scene.sources, job));
  EXPECT_EQ(scene.sources.at(0).hash, hash_file(folder_ / "box.glb"));
  EXPECT_EQ(energy.key, energy_key(scene.key, job.solve));
  EXPECT_EQ(read_transport_key(folder_ / "out/transport.h5"), transport_key(scene.geometry_key, job.solve));
  EXPECT_EQ(frame.metadata["patchlight:key"],
            frame_key(scene, energy.key, job, scene.cameras.at(0), 1, view_config_key(job.trace.picture.ocio)));
  ASSERT_TRUE(energy.estimate);
  EXPECT_EQ(frame.metadata["patchlight:error_bound"], fmt::format("{:.4g}", energy.estimate->error_bound));
  EXPECT_EQ(frame.metadata["patchlight:error_local"], fmt::format("{:.4g}", energy.estimate->error_local));
  for (const std::string& made_for : {scene.made.job, energy.made.job, frame.metadata["patchlight:job"]}) {
    Job read = parse_effective_job(made_for);
    EXPECT_EQ(read.scene, "box.glb");
    read.file = job.file;
    read.scene = job.scene;
    read.output = job.output;
    EXPECT_EQ(effective_job(read), effective_job(job));
  }
}

TEST_F(Rerun, RebuildsADamagedFileWithAWarning) {
  for (const auto& [file, ran] :
       {std::pair("out/patches.h5", "import"), std::pair("out/energy.h5", "solve"),
        std::pair("out/transport.h5", "solve"), std::pair("out/frames/camera.0001.exr", "trace")}) {
    const std::string whole = read_text(folder_ / file);
    folder_.write(file, whole.substr(0, whole.size() / 2));
    const Outcome outcome = run({});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(stages(outcome), ran) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: " + std::string(ran) + " runs again"));
  }
}

TEST_F(Rerun, RefusesTheSameJobsAsAFirstRun) {
  for (const char* set :
       {"trace.cameras=[nobody]", "lights.nobody.scale=1", "trace.view=Sepia", "trace.quality=magic"}) {
    const Outcome outcome = run({"--set", set});
    EXPECT_EQ(outcome.code, 78) << set << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("error: ")) << set;
  }
}

TEST_F(Rerun, TracesAgainForADamagedPngOrAnotherViewConfig) {
  const std::string whole = read_text(folder_ / "out/frames/camera.0001.png");
  folder_.write("out/frames/camera.0001.png", "");
  const Outcome outcome = run({});
  EXPECT_EQ(stages(outcome), "trace") << outcome.err;
  EXPECT_EQ(read_text(folder_ / "out/frames/camera.0001.png"), whole);
  std::filesystem::copy_file(std::string(PATCHLIGHT_SOURCE) + "/configs/config.ocio", folder_ / "config.ocio");
  EXPECT_EQ(stages(run_program(folder_, "patchlight", {"run", "job.yaml"}, "OCIO=config.ocio")), "trace");
}

TEST_F(Rerun, TreatsOtherFileTypesAsStale) {
  const auto exr = folder_ / "out/frames/camera.0001.exr";
  std::filesystem::remove(exr);
  ASSERT_EQ(mkfifo(exr.c_str(), 0600), 0);
  EXPECT_EQ(stages(run({})), "trace");
  EXPECT_EQ(run({"--output", std::string(300, 'x')}).code, 73);
  std::filesystem::remove(folder_ / "box.glb");
  std::filesystem::create_directory(folder_ / "box.glb");
  EXPECT_THAT(run({}).err, HasSubstr("import runs: "));
}

TEST_F(Rerun, TreatsAForeignImageAsStale) {
  write_exr(folder_ / "out/frames/camera.0001.exr", {16, 16, std::vector<Color>(256, Color(1.0f)), {}});
  EXPECT_EQ(stages(run({})), "trace");
}

TEST_F(Rerun, AcceptsJobsWithAnyName) {
  folder_.write("-job.yaml", read_text(folder_ / "job.yaml"));
  EXPECT_EQ(run_program(folder_, "patchlight", {"run", "--output", "dash", "--quiet", "--", "-job.yaml"}).code, 0);
}

TEST_F(Rerun, ForceRunsEverything) {
  EXPECT_EQ(stages(run({"--force"})), "import solve trace");
}

TEST_F(Rerun, StagesAlwaysRunByThemselves) {
  const Outcome outcome = run_program(folder_, "patchlight-trace", {"job.yaml"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("camera.0001.exr"));
}

TEST_F(Rerun, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const char* threads : {"1", "2", "3"}) {
    const std::string out = std::string("out") + threads;
    ASSERT_EQ(run({"--output", out, "--threads", threads}).code, 0);
    for (const char* file : {"patches.h5", "energy.h5", "frames/camera.0001.exr"}) {
      const Outcome diff = run_program(folder_, "patchlight", {"diff", std::string("out/") + file, out + "/" + file});
      EXPECT_EQ(diff.code, 0) << file << diff.out << diff.err;
    }
  }
}

TEST_F(Rerun, DiffReportsWhatDiffersAndByHowMuch) {
  ASSERT_EQ(run({"--output", "other", "--set", "solve.rays=80"}).code, 0);
  const auto diff = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"diff", "out/energy.h5", "other/energy.h5"});
    return run_program(folder_, "patchlight", more);
  };
  EXPECT_EQ(diff({}).code, 1);
  EXPECT_THAT(diff({}).out, HasSubstr("/groups/lights.ceiling/direct"));
  EXPECT_EQ(diff({"--tolerance", "0.5"}).code, 0);
  EXPECT_EQ(diff({"--tolerance", "0.5", "--max", "1e-6"}).code, 1);
  EXPECT_EQ(diff({"--max", "0.9", "--quiet"}).code, 0);
  EXPECT_EQ(diff({"--max", "1e-6"}).code, 1);
  EXPECT_THAT(diff({}).out, HasSubstr("/radiosity"));
  EXPECT_EQ(run_program(folder_, "patchlight", {"diff", "out/energy.h5", "out/patches.h5"}).code, 65);
}

TEST_F(Rerun, DiffComparesEveryDatasetOfPatches) {
  std::string glb = read_text(folder_ / "box.glb");
  const std::size_t at = glb.find("\"yfov\":0.6");
  ASSERT_NE(at, std::string::npos);
  glb[at + 9] = '7';
  folder_.write("box.glb", glb);
  ASSERT_EQ(run_program(folder_, "patchlight-import", {"job.yaml", "--output", "other"}).code, 0);
  const auto diff = [&](const std::string& more) {
    return run_program(folder_, "patchlight", {"diff", "out/patches.h5", "other/patches.h5", "--tolerance", more});
  };
  EXPECT_EQ(diff("0").code, 1);
  EXPECT_THAT(diff("0").out, HasSubstr("/cameras/lens"));
  EXPECT_THAT(diff("0").out, Not(HasSubstr("/patches/")));
  EXPECT_EQ(diff("0.5").code, 0);
}

TEST_F(Rerun, InfoDescribesEveryKindOfFile) {
  const auto info = [&](const std::string& file) { return run_program(folder_, "patchlight", {"info", file}).out; };
  EXPECT_THAT(info("box.glb"), HasSubstr("lights.ceiling"));
  EXPECT_THAT(info("out/patches.h5"), HasSubstr("lights.ceiling"));
  EXPECT_THAT(info("out/energy.h5"), HasSubstr("matrix over rays"));
  EXPECT_THAT(info("out/transport.h5"), HasSubstr("1 sampled apart"));
  EXPECT_THAT(info("out/frames/camera.0001.exr"), HasSubstr("32 x 32"));
}

}  // namespace
}  // namespace patchlight::test
