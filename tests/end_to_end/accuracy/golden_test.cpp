#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "pipeline/formats/solution/energy_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kGolden = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/";

/// What `patchlight diff` may find, by dataset or layer: the RMS of differences over that of the golden values, and the
/// largest over the largest.
struct Allowed {
  std::string name;
  std::string rms, largest;
};

// Another processor rounds otherwise, by which single rays may go to the other side of an edge: one of the 256 of a
// row, one of the few samples of a pixel. What is found without rays may differ in its last places alone.
const std::vector<Allowed> kPatches{{"*", "1e-6", "1e-6"}};
const std::vector<Allowed> kEnergy{{"*", "2e-3", "0.02"}, {"/display/mesh/*", "1e-6", "1e-6"}};
const std::vector<Allowed> kFrame{{"*", "2e-3", "0.05"},          {"albedo.*", "1e-3", "0.01"},
                                  {"normal.*", "1e-5", "1e-4"},   {"depth.*", "1e-5", "1e-4"},
                                  {"position.*", "1e-5", "1e-4"}, {"patch.*", "0", "0"}};

/// What each stage made of the demo scenes, kept in golden/. Each runs from the golden outputs of those before, and its
/// own is compared dataset by dataset, layer by layer. `golden/regenerate` makes them anew after a wanted change.
class Golden : public ::testing::TestWithParam<const char*> {
 protected:
  fs::path golden(const std::string& file) const { return fs::path(kGolden) / GetParam() / file; }

  void run(const std::string& stage, const std::vector<std::string>& inputs, std::vector<std::string> more = {}) {
    fs::remove_all(folder_ / "out");
    fs::create_directories(folder_ / "out");
    for (const auto& input : inputs) fs::copy_file(golden(input), folder_ / ("out/" + input));
    run_again(stage, std::move(more));
  }

  /// With what stands in its folder.
  void run_again(const std::string& stage, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {golden("job.yaml").string(), "--output", (folder_ / "out").string()});
    const Outcome outcome = run_program(folder_, "patchlight-" + stage, more);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }

  /// Compares what a stage made with its golden file.
  Outcome diff(const std::string& file, const std::string& made, const std::vector<Allowed>& limits) {
    std::vector<std::string> words{"diff", golden(file).string(), "out/" + made};
    for (const Allowed& limit : limits)
      for (const auto& [option, value] : {std::pair("--tolerance", limit.rms), {"--max", limit.largest}})
        words.insert(words.end(), {option, limit.name + "=" + value});
    return run_program(folder_, "patchlight", words);
  }

  /// A file that differs is kept for who wants to look.
  void expect_golden(const std::string& file, const std::string& made, const std::vector<Allowed>& limits) {
    const Outcome outcome = diff(file, made, limits);
    if (outcome.code == 0) return;
    const fs::path kept = fs::temp_directory_path() / "patchlight-golden" / GetParam() / file;
    fs::create_directories(kept.parent_path());
    fs::copy_file(folder_ / ("out/" + made), kept, fs::copy_options::overwrite_existing);
    ADD_FAILURE() << "From the golden files before it, the stage made another " << GetParam() << "/" << file
                  << " than the golden one, and more so than another processor's rounding would. It is kept as " << kept
                  << ".\n"
                  << outcome.out << outcome.err;
  }

  TemporaryFolder folder_;
};

TEST_P(Golden, PatchesAreAsTheyWere) {
  run("import", {});
  expect_golden("patches.h5", "patches.h5", kPatches);
}

TEST_P(Golden, EnergyIsAsItWasByRaysAndByTheRowsThatTheyLeave) {
  run("solve", {"patches.h5"});
  expect_golden("energy.h5", "energy.h5", kEnergy);
  EXPECT_GT(read_energy(folder_ / "out/energy.h5").rays, 0);
  run_again("solve");
  expect_golden("energy.h5", "energy.h5", kEnergy);
  EXPECT_EQ(read_energy(folder_ / "out/energy.h5").rays, 0);
}

TEST_P(Golden, FramesAndTheirLayersAreAsTheyWereByEachQuality) {
  for (const std::string quality : {"patches", "direct", "gather"}) {
    run("trace", {"patches.h5", "energy.h5"}, {"--set", "trace.quality=" + quality});
    expect_golden("frame." + quality + ".exr", "frames/camera.0001.exr", kFrame);
  }
}

/// The limits are narrow enough, and what is said tells where to look.
TEST_P(Golden, ADifferenceIsToldInWords) {
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

/// As OpenImageIO reads it.
TEST(Frame, LayersStandBesideTheBeautyByTheirNames) {
  const auto input = OIIO::ImageInput::open(kGolden + "mirror_room/frame.direct.exr");
  ASSERT_TRUE(input) << OIIO::geterror();
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.channelnames.size(), 3u + 3 * 5 + 3 * 2 + 2 + 3 * 2);
  const auto type_of = [&](const std::string& channel) {
    const auto at = std::find(spec.channelnames.begin(), spec.channelnames.end(), channel);
    return at == spec.channelnames.end() ? OIIO::TypeUnknown : spec.channelformat(int(at - spec.channelnames.begin()));
  };
  for (const char* name :
       {"R", "direct.R", "indirect.G", "specular.B", "emission.R", "albedo.G", "Combined_lights.window.R"})
    EXPECT_EQ(type_of(name), OIIO::TypeHalf) << name;
  for (const char* name : {"depth.Z", "normal.X", "position.Y"}) EXPECT_EQ(type_of(name), OIIO::TypeFloat) << name;
  EXPECT_EQ(type_of("patch.X"), OIIO::TypeUInt);
  EXPECT_FALSE(input->seek_subimage(1, 0)) << "one part";
  EXPECT_EQ(spec.get_string_attribute("Camera"), "camera");
  EXPECT_EQ(spec.get_string_attribute("Frame"), "0001");
  EXPECT_EQ(spec.get_string_attribute("Time"), "00:00:00:01");
  EXPECT_EQ(spec.get_string_attribute("Scene"), "mirror_room.glb");
}

}  // namespace
}  // namespace patchlight::test
