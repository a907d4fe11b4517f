#include <gmock/gmock.h>

#include "tests/end_to_end/program.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++count;
  return count;
}

/// Warnings of runs, of which the first makes all and the second finds it up to date.
class Warnings : public ProgramTest {
 protected:
  /// That both runs of a job give the warning once, and no other warning.
  void expect_in_both_runs(const std::string& warning, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"run",   "job.yaml",      "--quiet", "--set", "import.patch_area=0.004",
                                   "--set", "solve.rays=128"};
    words.insert(words.end(), more.begin(), more.end());
    std::string errors;
    for (const char* log : {"first.jsonl", "second.jsonl"}) {
      std::vector<std::string> logged = words;
      logged.insert(logged.end(), {"--log-json", log});
      const Outcome outcome = run_program(folder_, "patchlight", logged);
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr(warning));
      EXPECT_EQ(occurrences(outcome.err, "warning: "), 1u) << outcome.err;
      EXPECT_TRUE(errors.empty() || outcome.err == errors) << outcome.err;
      errors = outcome.err;
      EXPECT_EQ(occurrences(read_text(folder_ / log), "\"level\":\"warning\""), 1u);
    }
    EXPECT_EQ(occurrences(read_text(folder_ / "first.jsonl"), "\"repeated\":true"), 0u);
    EXPECT_EQ(occurrences(read_text(folder_ / "second.jsonl"), "\"repeated\":true"), 1u);
  }

  /// A floor without a material for each name, and a lamp above them.
  void write_floors(const std::vector<std::string>& names) {
    GltfBuilder gltf;
    const int lamp = gltf.material({{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}});
    const int floor = gltf.mesh(quad_mesh({Vec3f(0, 0, 0), Vec3f(0, 0, 1), Vec3f(1, 0, 1), Vec3f(1, 0, 0)}));
    const int light = gltf.mesh(quad_mesh({Vec3f(0, 2, 0), Vec3f(1, 2, 0), Vec3f(1, 2, 1), Vec3f(0, 2, 1)}), lamp);
    for (std::size_t i = 0; i < names.size(); ++i)
      gltf.node({{"name", names[i]}, {"mesh", floor}, {"translation", {double(i), 0, 0}}});
    gltf.node({{"name", "ceiling"}, {"mesh", light}});
    folder_.write("floors.glb", gltf.glb());
    folder_.write("job.yaml",
                  "scene: floors.glb\noutput: out\nimport: {patch_area: 0.1}\nsolve: {rays: 64}\n"
                  "trace: {resolution: [16, 16], samples: 4}\n");
  }
};

TEST_F(Warnings, TellAboutASceneWithoutLight) {
  small_job(folder_);
  expect_in_both_runs("patchlight-solve: warning: nothing in the scene emits light",
                      {"--set", "materials.light.emission=[0, 0, 0]"});
}

TEST_F(Warnings, TellAboutACameraThatSeesNothing) {
  small_job(folder_);
  expect_in_both_runs("patchlight-trace: warning: a camera stands outside the scene and sees nothing of it (`away`)",
                      {"--set", "cameras.away={look_from: [0, 0.28, 5], look_at: [0, 0.28, 9]}"});
}

TEST_F(Warnings, TellAboutABlackFrame) {
  small_job(folder_);
  expect_in_both_runs("patchlight-trace: warning: a frame is black (`behind`): no light reaches the surfaces in view",
                      {"--set", "cameras.behind={look_from: [0, 0.28, -3], look_at: [0, 0.28, 0]}"});
}

TEST_F(Warnings, TellAboutANearlyBlackFrame) {
  small_job(folder_);
  expect_in_both_runs("patchlight-trace: warning: a frame is nearly black (`camera`): its brightest pixel is",
                      {"--set", "lights.\"lights.ceiling\".scale=0.00001"});
}

TEST_F(Warnings, TellAboutAllBlackFramesAtOnce) {
  small_job(folder_);
  expect_in_both_runs(
      "a frame is black (`camera`, `spin` in 3 frames from 2 to 4): the job's `lights` turn every light group off",
      {"--set", "cameras.spin={look_from: [0, 0.28, 1.2], look_at: [0, 0.28, 0], turntable: 8}", "--set",
       "trace.frames=2-4", "--set", "lights.\"lights.ceiling\".scale=0"});
}

TEST_F(Warnings, TellAboutSurfacesWithoutAMaterial) {
  write_floors({"a", "b", "c", "d", "e", "f", "g"});
  expect_in_both_runs(
      "patchlight-import: warning: a surface without a material is diffuse grey, 0.8 (node `a`, `b`, "
      "`c`, `d`, `e` and 2 more): give it a material, or set `materials.default: ");
}

TEST_F(Warnings, AreNotGivenWhereTheJobSaysWhatASurfaceReflects) {
  write_floors({"a"});
  const Outcome outcome = run_program(
      folder_, "patchlight", {"run", "job.yaml", "--quiet", "--set", "materials.default.reflectance=[0.8, 0.8, 0.8]"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Warnings, OfOneRunAloneAreNotRepeated) {
  small_job(folder_);
  const std::vector<std::string> run{
      "run", "job.yaml", "--quiet", "--set", "cache=0", "--set", "import.patch_area=0.004", "--set", "solve.rays=128"};
  ASSERT_EQ(run_program(folder_, "patchlight", run).code, 0);
  folder_.write("out/transport.h5", "damaged");
  EXPECT_THAT(run_program(folder_, "patchlight", run).err,
              HasSubstr("patchlight-solve: warning: casting all rays again"));
  EXPECT_EQ(run_program(folder_, "patchlight", run).err, "");
}

}  // namespace
}  // namespace patchlight::test
