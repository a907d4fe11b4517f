#include "tests/end_to_end/relight/relight_job.h"

namespace patchlight::test {
namespace {

const std::vector<std::string> kFading{
    "--set", "lights={lights.ceiling: {scale: {1: 4, 3: 0}}, wall: {scale: {2: 1, 3: 3}, color: {1: [1, 0, 0]}}}",
    "--set", "trace.frames=1-3"};

TEST_F(Relight, LightsThatChangeGiveAStillCameraAllFrames) {
  write("float", "[light_groups]");
  ASSERT_EQ(patchlight("run", kFading).code, 0);
  const std::vector<std::pair<float, Color>> expected{{4, Color(1, 0, 0)}, {2, Color(1, 0, 0)}, {0, Color(3, 0, 0)}};
  for (int number = 1; number <= 3; ++number) {
    const Image image = read_exr_layers(frame("camera.000" + std::to_string(number) + ".exr"));
    const auto layer = [&](const std::string& group) {
      const auto found = std::find_if(image.layers.begin(), image.layers.end(),
                                      [&](const ImageLayer& one) { return one.name == "Combined_" + group; });
      return std::get<std::vector<Color>>(found->values);
    };
    const std::vector<Color> ceiling = layer("lights.ceiling"), wall = layer("wall");
    const auto& [scale, color] = expected[std::size_t(number) - 1];
    for (std::size_t p = 0; p < image.pixels.size(); ++p) {
      const Color sum = ceiling[p] * scale + wall[p] * color;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(image.pixels[p][k], sum[k], 2e-6 + 2e-5 * sum[k]) << number << ' ' << p;
    }
  }
}

TEST_F(Relight, ALaterKeyLeavesEarlierFramesFreshAndNeverSolves) {
  ASSERT_EQ(patchlight("run", kFading).code, 0);
  const Outcome outcome = patchlight("run", concatenated(kFading, {"--set", "lights.wall.scale={2: 1, 3: 5}"}));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("solve skipped"));
  EXPECT_THAT(outcome.err, HasSubstr("2 of 3 frames are up to date"));
  EXPECT_EQ(patchlight("status", concatenated(kFading, {"--set", "lights.wall.scale={2: 1, 3: 5}"})).code, 0);
}

TEST_F(Relight, RelitFramesFollowTheLights) {
  write("float", "[light_groups]");
  ASSERT_EQ(patchlight("run", concatenated(kTwoFrames, {"--set", "lights.wall.scale=1"})).code, 0);
  const std::vector<std::string> fading = concatenated(kTwoFrames, {"--set", "lights.wall.scale={1: 1, 2: 0}"});
  ASSERT_EQ(patchlight("relight", fading).code, 0);
  ASSERT_EQ(patchlight("run", fading).code, 0);
  for (const char* name : {"spin.0001.exr", "spin.0002.exr"}) {
    const Image made = read_exr(relit(name)), traced = read_exr(frame(name));
    for (std::size_t p = 0; p < traced.pixels.size(); ++p)
      EXPECT_NEAR(made.pixels[p].y, traced.pixels[p].y, 2e-6 + 2e-5 * traced.pixels[p].y) << name << ' ' << p;
  }
}

}  // namespace
}  // namespace patchlight::test
