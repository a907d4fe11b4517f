#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gmock/gmock.h>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kGolden = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/mirror_room/";

/// Previews of the golden job against golden pictures.
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

TEST_P(Preview, IsAsItWas) {
  const std::string kind = GetParam();
  const Outcome outcome = preview({"--kind", kind, "--patch", "60", "--set", "solve.hemicube_resolution=32"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const OIIO::ImageBuf golden(kGolden + "preview." + kind + ".png"),
      drawn((folder_ / ("out/preview/" + kind + ".patch60.png")).string());
  ASSERT_TRUE(golden.spec().width > 0 && golden.spec().width == drawn.spec().width);
  const auto difference = OIIO::ImageBufAlgo::compare(drawn, golden, 0.1f, 0.02f);
  // Another driver may round an edge to the other side of a pixel.
  EXPECT_LT(double(difference.nfail), 0.01 * double(golden.spec().image_pixels()));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Preview, ::testing::Values("patches", "radiosity", "irradiance", "hemicube"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST_F(Preview, NamesPatchesAndCamerasThatThereAre) {
  EXPECT_EQ(preview({"--patch", "999999"}).code, 78);
  EXPECT_THAT(preview({"--patch", "999999"}).err, HasSubstr("the scene has patches 0 to"));
  EXPECT_EQ(preview({"--camera", "nobody"}).code, 78);
  EXPECT_EQ(preview({"--kind", "smell"}).code, 64);
}

}  // namespace
}  // namespace patchlight::test
