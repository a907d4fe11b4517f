#include <gmock/gmock.h>

#include "tests/end_to_end/program.h"
#include "tests/images.h"

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
  const Pixels golden = read_image(kGolden + "preview." + kind + ".png"),
               drawn = read_image(folder_ / ("out/preview/" + kind + ".patch60.png"));
  ASSERT_EQ(golden.width, drawn.width);
  ASSERT_EQ(golden.values.size(), drawn.values.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < drawn.values.size(); ++i) differing += std::abs(drawn.values[i] - golden.values[i]) > 0.1;
  // OpenGL drivers round edges to pixels differently.
  EXPECT_LT(double(differing), 0.01 * double(golden.width * golden.height));
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
