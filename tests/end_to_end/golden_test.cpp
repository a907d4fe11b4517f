#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

// What each stage made of the golden job, kept in golden/. `golden/regenerate` makes them anew after a wanted change.
const std::string kGolden = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/";

/// Runs one stage from the golden output of the one before and compares its own.
class Golden : public ProgramTest {
 protected:
  void expect_same(const std::string& stage, const std::vector<std::string>& inputs, const std::string& golden,
                   const std::string& output, const std::string& tolerance, std::vector<std::string> more = {}) {
    std::filesystem::create_directories(folder_ / "out");
    for (const auto& input : inputs) std::filesystem::copy_file(kGolden + input, folder_ / ("out/" + input));
    more.insert(more.begin(), {kGolden + "job.yaml", "--output", (folder_ / "out").string()});
    const Outcome outcome = run_program(folder_, "patchlight-" + stage, more);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Outcome diff =
        run_program(folder_, "patchlight", {"diff", kGolden + golden, "out/" + output, "--tolerance", tolerance});
    EXPECT_EQ(diff.code, 0) << diff.out << diff.err;
  }
};

TEST_F(Golden, PatchesAreAsTheyWere) {
  expect_same("import", {}, "patches.h5", "patches.h5", "1e-6");
}

// A processor of another kind may send single rays to the other side of an edge.
TEST_F(Golden, EnergyIsAsItWas) {
  expect_same("solve", {"patches.h5"}, "energy.h5", "energy.h5", "2e-3");
}

TEST_F(Golden, FramesAndTheirLayersAreAsTheyWereByEachQuality) {
  for (const std::string quality : {"patches", "direct", "gather"}) {
    expect_same("trace", {"patches.h5", "energy.h5"}, "frame." + quality + ".exr", "frames/camera.0001.exr", "2e-3",
                {"--set", "trace.quality=" + quality});
    std::filesystem::remove_all(folder_ / "out");
  }
}

/// As OpenImageIO reads it.
TEST(Frame, LayersStandBesideTheBeautyByTheirNames) {
  const auto input = OIIO::ImageInput::open(kGolden + "frame.direct.exr");
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
