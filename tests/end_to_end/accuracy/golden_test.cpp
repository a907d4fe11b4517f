#include <gmock/gmock.h>

#include <algorithm>

#include "pipeline/formats/solution/energy_file.h"
#include "tests/end_to_end/program.h"
#include "tests/images.h"

namespace patchlight::test {
namespace {

const std::string kGolden = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/";

/// Tolerances of `patchlight diff` for a dataset or layer: RMS of the differences over RMS of the golden values, and
/// largest difference over largest golden value.
struct Tolerance {
  std::string name;
  std::string rms, largest;
};

// Rounding differs between processors, so a single ray may pass the other side of an edge: one of the 256 rays of a
// row, or one of a pixel's few samples. Values computed without rays differ in the last digits only.
const std::vector<Tolerance> kPatches{{"*", "1e-6", "1e-6"}};
const std::vector<Tolerance> kEnergy{{"*", "2e-3", "0.02"}, {"/display/mesh/*", "1e-6", "1e-6"}};
const std::vector<Tolerance> kFrame{{"*", "2e-3", "0.05"},          {"albedo.*", "1e-3", "0.01"},
                                    {"normal.*", "1e-5", "1e-4"},   {"depth.*", "1e-5", "1e-4"},
                                    {"position.*", "1e-5", "1e-4"}, {"patch.*", "0", "0"}};

/// Compares the output of each stage, run from the golden outputs of the earlier stages, with the golden file, dataset
/// by dataset and layer by layer. `golden/regenerate` renews the golden files after an intended change.
class Golden : public ::testing::TestWithParam<const char*> {
 protected:
  fs::path golden(const std::string& file) const { return fs::path(kGolden) / GetParam() / file; }

  void run(const std::string& stage, const std::vector<std::string>& inputs, std::vector<std::string> more = {}) {
    fs::remove_all(folder_ / "out");
    fs::create_directories(folder_ / "out");
    for (const auto& input : inputs) fs::copy_file(golden(input), folder_ / ("out/" + input));
    run_again(stage, std::move(more));
  }

  /// Runs a stage with the present content of its output folder.
  void run_again(const std::string& stage, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {golden("job.yaml").string(), "--output", (folder_ / "out").string()});
    const Outcome outcome = run_program(folder_, "patchlight-" + stage, more);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }

  /// Compares an output of a stage with its golden file.
  Outcome diff(const std::string& file, const std::string& made, const std::vector<Tolerance>& tolerances) {
    std::vector<std::string> words{"diff", golden(file).string(), "out/" + made};
    for (const Tolerance& tolerance : tolerances)
      for (const auto& [option, value] : {std::pair("--tolerance", tolerance.rms), {"--max", tolerance.largest}})
        words.insert(words.end(), {option, tolerance.name + "=" + value});
    return run_program(folder_, "patchlight", words);
  }

  /// Keeps a file that differs for inspection.
  void expect_golden(const std::string& file, const std::string& made, const std::vector<Tolerance>& tolerances) {
    const Outcome outcome = diff(file, made, tolerances);
    if (outcome.code == 0) return;
    const fs::path kept = fs::temp_directory_path() / "patchlight-golden" / GetParam() / file;
    fs::create_directories(kept.parent_path());
    fs::copy_file(folder_ / ("out/" + made), kept, fs::copy_options::overwrite_existing);
    ADD_FAILURE() << GetParam() << "/" << file << " differs from the golden file by more than the rounding of another "
                  << "processor. The new file is kept as " << kept << ".\n"
                  << outcome.out << outcome.err;
  }

  TemporaryFolder folder_;
};

TEST_P(Golden, PatchesMatch) {
  run("import", {});
  expect_golden("patches.h5", "patches.h5", kPatches);
}

TEST_P(Golden, EnergyMatchesWithNewAndWithStoredFormFactors) {
  run("solve", {"patches.h5"});
  expect_golden("energy.h5", "energy.h5", kEnergy);
  EXPECT_GT(read_energy(folder_ / "out/energy.h5").rays, 0);
  run_again("solve");
  expect_golden("energy.h5", "energy.h5", kEnergy);
  EXPECT_EQ(read_energy(folder_ / "out/energy.h5").rays, 0);
}

TEST_P(Golden, FramesAndTheirLayersMatchInEveryQuality) {
  for (const std::string quality : {"patches", "direct", "gather"}) {
    run("trace", {"patches.h5", "energy.h5"}, {"--set", "trace.quality=" + quality});
    expect_golden("frame." + quality + ".exr", "frames/camera.0001.exr", kFrame);
  }
}

/// The tolerances detect a small change, and the message says where it is.
TEST_P(Golden, DiffReportsWhereFilesDiffer) {
  run("solve", {"patches.h5"}, {"--set", "solve.seed=2"});
  Outcome outcome = diff("energy.h5", "energy.h5", kEnergy);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out,
              ContainsRegex("/groups/lights.ceiling/indirect +differs: [0-9]+ of [0-9]+ values, relative RMS "
                            "[0-9.e-]+, largest [0-9.e-]+ at row [0-9]+, value [0-2]: expected [0-9.e-]+, "
                            "found [0-9.e-]+\n"));
  run("trace", {"patches.h5", "energy.h5"}, {"--set", "lights.\"lights.ceiling\".scale=1.01"});
  outcome = diff("frame.direct.exr", "frames/camera.0001.exr", kFrame);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, ContainsRegex("direct.RGB +differs: .* at pixel \\([0-9]+, [0-9]+\\), [RGB]: expected "
                                         "[0-9.e-]+, found [0-9.e-]+\n"));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Golden, ::testing::Values("cornell_box", "mirror_room"),
                         [](const auto& scene) { return std::string(scene.param); });

/// Read by OpenImageIO.
TEST(Frame, HoldsLayersAsNamedChannelsBesideTheBeauty) {
  ImageHeader header = image_header(kGolden + "mirror_room/frame.direct.exr");
  EXPECT_EQ(header.channel_types.size(), 3u + 3 * 5 + 3 * 2 + 2 + 3 * 2);
  for (const char* name :
       {"R", "direct.R", "indirect.G", "specular.B", "emission.R", "albedo.G", "Combined_lights.window.R"})
    EXPECT_EQ(header.channel_types[name], "half") << name;
  for (const char* name : {"depth.Z", "normal.X", "position.Y"}) EXPECT_EQ(header.channel_types[name], "float") << name;
  EXPECT_EQ(header.channel_types["patch.X"], "uint");
  EXPECT_EQ(header.parts, 1);
  EXPECT_EQ(header.text["Camera"], "camera");
  EXPECT_EQ(header.text["Frame"], "0001");
  EXPECT_EQ(header.text["Time"], "00:00:00:01");
  EXPECT_EQ(header.text["Scene"], "mirror_room.glb");
}

}  // namespace
}  // namespace patchlight::test
