#include <algorithm>

#include "pipeline/system/content_hash.h"
#include "tests/end_to_end/relight/relight_job.h"
#include "tests/images.h"

namespace patchlight::test {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> names(const Image& image) {
  std::vector<std::string> result;
  for (const ImageLayer& layer : image.layers) result.push_back(layer.name);
  return result;
}

TEST_F(Relight, AgreesWithATrace) {
  EXPECT_LT(error("float"), 2e-6);
  // Rounding of the layers, of their sum and of the traced frame.
  const double half_error = error("half");
  EXPECT_LT(half_error, 3 * 5e-4);
  EXPECT_GT(half_error, 0);
}

TEST_F(Relight, WritesAMatchingPng) {
  ASSERT_EQ(patchlight("run").code, 0);
  ASSERT_EQ(patchlight("relight", kOtherLights).code, 0);
  EXPECT_EQ(read_exr_header(relit()).metadata["patchlight:png"], hash_file(relit("camera.0001.png")));
  const auto differing = [&] {
    const std::vector<float> traced = read_image(frame("camera.0001.png")).values,
                             made = read_image(relit("camera.0001.png")).values;
    EXPECT_EQ(traced.size(), made.size());
    int values = 0;
    for (std::size_t i = 0; i < traced.size(); ++i) values += std::abs(traced[i] - made[i]) > 1.5f / 255;
    return values;
  };
  EXPECT_GT(differing(), 1000);
  ASSERT_EQ(patchlight("run", kOtherLights).code, 0);
  EXPECT_EQ(differing(), 0);
}

TEST_F(Relight, KeepsLayersThatLightsDoNotChange) {
  write("half", "[direct, albedo, normal, light_groups, depth, patch, emission]");
  ASSERT_EQ(patchlight("run").code, 0);
  const Outcome outcome = patchlight("relight", kOtherLights);
  EXPECT_THAT(outcome.err, HasSubstr("warning: relit frames leave out the layers direct, emission, which"));
  const Image source = read_exr_layers(frame()), made = read_exr_layers(relit());
  EXPECT_THAT(names(made),
              ElementsAre("Combined_lights.ceiling", "Combined_wall", "albedo", "depth", "normal", "patch"));
  for (const ImageLayer& layer : made.layers) {
    const auto same_name = [&](const ImageLayer& other) { return other.name == layer.name; };
    EXPECT_EQ(std::find_if(source.layers.begin(), source.layers.end(), same_name)->values, layer.values) << layer.name;
  }
}

TEST_F(Relight, NamesUnusableFramesAndContinues) {
  write("half", "[light_groups]",
        "cameras:\n  spin: {look_from: [0, 0.28, 1.2], look_at: [0, 0.28, 0], turntable: 8}\n");
  const std::vector<std::string> range{"--set", "trace.cameras=[spin]", "--set", "trace.frames=1-5"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), range.begin(), range.end());
    return more;
  };
  ASSERT_EQ(patchlight("run", range).code, 0);
  ASSERT_EQ(
      patchlight("run", {"--set", "trace.cameras=[spin]", "--set", "trace.frames=2", "--set", "trace.samples=1"}).code,
      0);
  fs::remove(frame("spin.0003.exr"));
  Image bare = read_exr_layers(frame("spin.0004.exr"));
  bare.layers.pop_back();
  write_exr(frame("spin.0004.exr"), bare);
  const std::string whole = read_text(frame("spin.0005.exr"));
  folder_.write("out/frames/spin.0005.exr", whole.substr(0, whole.size() / 2));

  const Outcome outcome = patchlight("relight", with(kOtherLights));
  EXPECT_EQ(outcome.code, 65) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("other inputs: trace.samples 1 -> 4 ("));
  EXPECT_THAT(outcome.err, HasSubstr("spin.0002.exr): render it by `patchlight run`"));
  EXPECT_THAT(outcome.err, HasSubstr("spin.0003.exr): render it by `patchlight run`"));
  EXPECT_THAT(outcome.err, HasSubstr("it lacks the layer `Combined_wall` ("));
  EXPECT_THAT(outcome.err, HasSubstr("spin.0004.exr): render it by `patchlight run`"));
  EXPECT_THAT(outcome.err, ContainsRegex("a damaged EXR: .*spin.0005.exr"));
  EXPECT_THAT(outcome.err, HasSubstr("error: 4 of 5 frames could not be relit"));
  EXPECT_TRUE(fs::exists(relit("spin.0001.exr")));
  for (const char* name : {"spin.0002.exr", "spin.0003.exr", "spin.0004.exr", "spin.0005.exr"})
    EXPECT_FALSE(fs::exists(relit(name))) << name;
  fs::remove(frame("spin.0001.exr"));
  EXPECT_EQ(patchlight("relight", with({})).code, 66);
  ASSERT_EQ(patchlight("run", range).code, 0);
  const Outcome again = patchlight("relight", with(kOtherLights));
  EXPECT_EQ(again.code, 0) << again.err;
}

}  // namespace
}  // namespace patchlight::test
