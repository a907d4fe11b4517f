#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "pipeline/files/image_file.h"
#include "pipeline/files/key.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

using ::testing::ElementsAre;

const std::vector<std::string> kOtherLights{"--set", "lights.\"lights.ceiling\"={scale: 0.3, color: [1, 0.5, 0.2]}",
                                            "--set", "lights.wall.scale=2",
                                            "--set", "trace.exposure=0.5"};

/// The box with a wall that is a second lamp.
class Relight : public ProgramTest {
 protected:
  void SetUp() override { write("half", "[light_groups]"); }

  void write(const std::string& pixel_type, const std::string& layers, const std::string& more = "") {
    small_job(folder_);
    folder_.write("job.yaml",
                  "scene: box.glb\noutput: out\nimport: {patch_area: 0.01}\nsolve: {rays: 64}\n"
                  "materials: {green: {emission: [0.2, 1, 0.5], light_group: wall}}\n"
                  "lights: {lights.ceiling: {scale: 4}}\n"
                  "trace: {resolution: [40, 32], samples: 4, pixel_type: " +
                      pixel_type + ", layers: " + layers + "}\n" + more);
  }

  Outcome patchlight(const std::string& command, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{command, "job.yaml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(folder_, "patchlight", arguments);
  }

  /// The largest difference between a relit frame's light and that of one traced under the same lights, over 1e-3 plus
  /// the latter.
  double error(const std::string& pixel_type) {
    write(pixel_type, "[light_groups]");
    EXPECT_EQ(patchlight("run").code, 0);
    Outcome outcome = patchlight("relight", kOtherLights);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    outcome = patchlight("run", kOtherLights);
    EXPECT_THAT(outcome.err, HasSubstr("trace runs"));
    const Image traced = read_exr(frame()), made = read_exr(relit());
    EXPECT_EQ(made.pixels.size(), traced.pixels.size());
    double most = 0;
    for (std::size_t p = 0; p < traced.pixels.size(); ++p)
      for (int k = 0; k < 3; ++k)
        most = std::max(most, std::abs(double(made.pixels[p][k]) - traced.pixels[p][k]) / (1e-3 + traced.pixels[p][k]));
    return most;
  }

  fs::path frame(const std::string& name = "camera.0001.exr") const { return folder_ / ("out/frames/" + name); }
  fs::path relit(const std::string& name = "camera.0001.exr") const { return folder_ / ("out/relit/" + name); }
};

std::vector<std::string> names(const Image& image) {
  std::vector<std::string> result;
  for (const ImageLayer& layer : image.layers) result.push_back(layer.name);
  return result;
}

/// Of a PNG, as it stands on the disk now.
std::vector<std::uint8_t> bytes(const fs::path& png) {
  const auto input = OIIO::ImageInput::open(png.string());
  std::vector<std::uint8_t> values(input->spec().image_bytes());
  input->read_image(0, 0, 0, input->spec().nchannels, OIIO::TypeDesc::UINT8, values.data());
  return values;
}

TEST_F(Relight, MakesWhatATraceWould) {
  EXPECT_LT(error("float"), 2e-6);
  // The layers are rounded, and so is what is made of them, and what is traced.
  const double of_halves = error("half");
  EXPECT_LT(of_halves, 3 * 5e-4);
  EXPECT_GT(of_halves, 0);
}

TEST_F(Relight, LetsThePngFollow) {
  ASSERT_EQ(patchlight("run").code, 0);
  ASSERT_EQ(patchlight("relight", kOtherLights).code, 0);
  EXPECT_EQ(read_exr_header(relit()).metadata["patchlight:png"], hash_file(relit("camera.0001.png")));
  const auto differing = [&] {
    const std::vector<std::uint8_t> traced = bytes(frame("camera.0001.png")), made = bytes(relit("camera.0001.png"));
    EXPECT_EQ(traced.size(), made.size());
    int values = 0;
    for (std::size_t i = 0; i < traced.size(); ++i) values += std::abs(traced[i] - made[i]) > 1;
    return values;
  };
  EXPECT_GT(differing(), 1000);
  ASSERT_EQ(patchlight("run", kOtherLights).code, 0);
  EXPECT_EQ(differing(), 0);
}

TEST_F(Relight, LeavesTracedFramesAsTheyAre) {
  ASSERT_EQ(patchlight("run").code, 0);
  const std::string before = read_text(frame());
  const Outcome outcome = patchlight("relight", kOtherLights);
  EXPECT_THAT(outcome.err, HasSubstr("relit/camera.0001.exr in "));
  EXPECT_EQ(read_text(frame()), before);
  EXPECT_EQ(patchlight("status").code, 0);
  EXPECT_EQ(patchlight("status", kOtherLights).code, 1);
  Image source = read_exr_header(frame()), made = read_exr_header(relit());
  EXPECT_EQ(made.metadata["patchlight:relit_from"], source.metadata["patchlight:key"]);
  EXPECT_THAT(made.metadata["patchlight:job"], HasSubstr("wall:\n    scale: 2\n"));
  // What is relit is close to a trace, but is none.
  fs::copy_file(relit(), frame(), fs::copy_options::overwrite_existing);
  fs::copy_file(relit("camera.0001.png"), frame("camera.0001.png"), fs::copy_options::overwrite_existing);
  EXPECT_THAT(patchlight("status", kOtherLights).out, HasSubstr("stale"));
}

TEST_F(Relight, KeepsLayersThatLightsDoNotChange) {
  write("half", "[direct, albedo, normal, light_groups, depth, patch, emission]");
  ASSERT_EQ(patchlight("run").code, 0);
  const Outcome outcome = patchlight("relight", kOtherLights);
  EXPECT_THAT(outcome.err, HasSubstr("warning: relit frames are without the layers direct, emission, which"));
  const Image source = read_exr_layers(frame()), made = read_exr_layers(relit());
  EXPECT_THAT(names(made),
              ElementsAre("Combined_lights.ceiling", "Combined_wall", "albedo", "depth", "normal", "patch"));
  for (const ImageLayer& layer : made.layers) {
    const auto same_name = [&](const ImageLayer& other) { return other.name == layer.name; };
    EXPECT_EQ(std::find_if(source.layers.begin(), source.layers.end(), same_name)->values, layer.values) << layer.name;
  }
}

TEST_F(Relight, NamesFramesThatCannotBeUsedAndGoesOn) {
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
  EXPECT_THAT(outcome.err, HasSubstr("something else: trace.samples 1 -> 4 ("));
  EXPECT_THAT(outcome.err, HasSubstr("spin.0002.exr): render it by `patchlight run`"));
  EXPECT_THAT(outcome.err, HasSubstr("spin.0003.exr): render it by `patchlight run`"));
  EXPECT_THAT(outcome.err, HasSubstr("it lacks the layer `Combined_wall` ("));
  EXPECT_THAT(outcome.err, HasSubstr("spin.0004.exr): remove it, and `patchlight run`"));
  EXPECT_THAT(outcome.err, ContainsRegex("a damaged EXR: .*spin.0005.exr"));
  EXPECT_THAT(outcome.err, HasSubstr("error: 4 of 5 frames could not be relit"));
  EXPECT_TRUE(fs::exists(relit("spin.0001.exr")));
  for (const char* name : {"spin.0002.exr", "spin.0003.exr", "spin.0004.exr", "spin.0005.exr"})
    EXPECT_FALSE(fs::exists(relit(name))) << name;
  for (const char* name : {"spin.0001.exr", "spin.0004.exr"}) fs::remove(frame(name));
  EXPECT_EQ(patchlight("relight", with({})).code, 66);
  ASSERT_EQ(patchlight("run", range).code, 0);
  const Outcome again = patchlight("relight", with(kOtherLights));
  EXPECT_EQ(again.code, 0) << again.err;
}

TEST_F(Relight, RefusesWhatOnlyARunCanMake) {
  Outcome outcome = patchlight("relight");
  EXPECT_EQ(outcome.code, 66);
  EXPECT_THAT(outcome.err, HasSubstr("nothing to relight yet"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  ASSERT_EQ(patchlight("run").code, 0);
  outcome = patchlight("relight", {"--set", "trace.layers=[]"});
  EXPECT_EQ(outcome.code, 78);
  EXPECT_THAT(outcome.err, HasSubstr("add `light_groups` to it"));
  EXPECT_EQ(patchlight("relight", {"--set", "lights.moon.scale=2"}).code, 78);
  EXPECT_EQ(patchlight("relight", {"--set", "trace.view=none"}).code, 78);
  outcome = patchlight("relight", {"--set", "solve.rays=65"});
  EXPECT_EQ(outcome.code, 65);
  EXPECT_THAT(outcome.err, HasSubstr("solve.rays 64 -> 65"));
  outcome = patchlight("relight", {"--set", "import.patch_area=0.02"});
  EXPECT_EQ(outcome.code, 65);
  EXPECT_THAT(outcome.err, HasSubstr("of another scene: import.patch_area 0.01 -> 0.02"));
  EXPECT_EQ(run_program(folder_, "patchlight-trace", {"job.yaml", "--relight", "--skip-fresh"}).code, 64);
  EXPECT_FALSE(fs::exists(folder_ / "out/relit"));
}

TEST_F(Relight, DoesAllVariantsAndIsCleaned) {
  write("half", "[light_groups]", "matrix: {trace.samples: [1, 4]}\n");
  ASSERT_EQ(patchlight("run", {"--variant", "4"}).code, 0);
  const Outcome outcome = patchlight("relight", kOtherLights);
  EXPECT_EQ(outcome.code, 66) << outcome.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/4/relit/camera.0001.exr"));
  EXPECT_EQ(patchlight("relight", {"--variant", "4"}).code, 0);
  EXPECT_EQ(patchlight("clean", {"--all"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace patchlight::test
