#pragma once
#include <algorithm>
#include <cmath>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {

inline const std::vector<std::string> kOtherLights{
    "--set", "lights.\"lights.ceiling\"={scale: 0.3, color: [1, 0.5, 0.2]}",
    "--set", "lights.wall.scale=2",
    "--set", "trace.exposure=0.5"};

inline const std::vector<std::string> kTwoFrames{
    "--set", "cameras.spin={look_from: [0, 0.28, 1.2], look_at: [0, 0.28, 0], turntable: 8}",
    "--set", "trace.cameras=[spin]",
    "--set", "trace.frames=1-2"};

inline std::vector<std::string> concatenated(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Relights the Cornell box, whose green wall emits light as well, in a light group of its own.
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

  /// Largest error of a relit frame against one traced under the same lights, relative to the traced value + 1e-3.
  double error(const std::string& pixel_type) {
    write(pixel_type, "[light_groups]");
    EXPECT_EQ(patchlight("run").code, 0);
    Outcome outcome = patchlight("relight", kOtherLights);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    outcome = patchlight("run", kOtherLights);
    EXPECT_THAT(outcome.err, HasSubstr("trace runs"));
    const Image traced = read_exr(frame()), relit_frame = read_exr(relit());
    EXPECT_EQ(relit_frame.pixels.size(), traced.pixels.size());
    double largest = 0;
    for (std::size_t p = 0; p < traced.pixels.size(); ++p)
      for (int k = 0; k < 3; ++k)
        largest = std::max(
            largest, std::abs(double(relit_frame.pixels[p][k]) - traced.pixels[p][k]) / (1e-3 + traced.pixels[p][k]));
    return largest;
  }

  /// Number of relit frames.
  static int relit_count(const Outcome& outcome) {
    static const std::regex line("relit/[^ ]+ in ");
    return int(std::distance(std::sregex_iterator(outcome.err.begin(), outcome.err.end(), line), {}));
  }

  fs::path frame(const std::string& name = "camera.0001.exr") const { return folder_ / ("out/frames/" + name); }
  fs::path relit(const std::string& name = "camera.0001.exr") const { return folder_ / ("out/relit/" + name); }
};

}  // namespace patchlight::test
