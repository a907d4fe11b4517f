#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gmock/gmock.h>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kGolden = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/mirror_room/";

/// Compares previews of the golden job with golden images.
class Preview : public ::testing::TestWithParam<const char*> {
 protected:
  Outcome preview(std::vector<std::string> more) {
    std::filesystem::create_directories(folder_ / "out");
    for (const char* input : {"patches.h5", "energy.h5"})
      std::filesystem::copy_file(kGolden + input, folder_ / (std::string("out/") + input),
                                 std::filesystem::copy_options::overwrite_existing);
    more.insert(more.begin(), {"preview", kGolden + "job.yaml", "--output", (folder_ / "out").string()});
    return run_program(folder_, "patchlight", more);
  }
  TemporaryFolder folder_;
};

TEST_P(Preview, MatchesTheGoldenImage) {
  const std::string kind = GetParam();
  const Outcome outcome = preview({"--kind", kind, "--patch", "60", "--set", "solve.hemicube_resolution=32"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const OIIO::ImageBuf golden(kGolden + "preview." + kind + ".png"),
      drawn((folder_ / ("out/preview/" + kind + ".patch60.png")).string());
  ASSERT_TRUE(golden.spec().width > 0 && golden.spec().width == drawn.spec().width);
  const auto difference = OIIO::ImageBufAlgo::compare(drawn, golden, 0.1f, 0.02f);
  // OpenGL drivers round edges to pixels differently.
  EXPECT_LT(double(difference.nfail), 0.01 * double(golden.spec().image_pixels()));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Preview, ::testing::Values("patches", "radiosity", "irradiance", "hemicube"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST_F(Preview, RefusesUnknownPatchesCamerasAndKinds) {
  EXPECT_EQ(preview({"--patch", "999999"}).code, 78);
  EXPECT_THAT(preview({"--patch", "999999"}).err, HasSubstr("the scene has patches 0 to"));
  EXPECT_EQ(preview({"--camera", "nobody"}).code, 78);
  EXPECT_EQ(preview({"--kind", "smell"}).code, 64);
}

}  // namespace
}  // namespace patchlight::test
