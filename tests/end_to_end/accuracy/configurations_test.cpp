#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/image/image_error.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kScenes = PATCHLIGHT_SCENES;

/// Discretisation error: the limit of the difference from the path tracer for infinitely many rays.
constexpr double kDiscretisationError = 0.004;

struct Configuration {
  const char* method;
  const char* form_factors;
  std::vector<std::string> settings;
};
const std::array<Configuration, 4> kConfigurations{
    {{"matrix", "rays", {"solve.rays=1024"}},
     {"matrix", "hemicube", {"solve.hemicube_resolution=64"}},
     {"progressive", "rays", {"solve.rays=4096"}},
     {"progressive", "hemicube", {"solve.hemicube_resolution=64", "solve.tolerance=0.003"}}}};

class Configurations : public ProgramTest {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kScenes + "/reference/cornell.exr"))
      GTEST_SKIP() << "no reference scenes at " << kScenes;
    folder_.write("job.yaml",
                  "scene: " + kScenes + "/blender/cornell.glb\ntrace: {resolution: [256, 256], samples: 16}\n");
  }

  void run(const std::string& program, const Configuration& configuration, const std::string& output,
           const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments;
    if (program == "patchlight") arguments.push_back("run");
    arguments.insert(arguments.end(), {"job.yaml", "--output", output});
    for (const auto& set : {std::string("solve.method=") + configuration.method,
                            std::string("solve.form_factors=") + configuration.form_factors})
      arguments.insert(arguments.end(), {"--set", set});
    for (const auto* sets : {&configuration.settings, &more})
      for (const auto& set : *sets) arguments.insert(arguments.end(), {"--set", set});
    const Outcome outcome = run_program(folder_, program, arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }

  Image frame(const std::string& output) const { return read_exr(folder_ / (output + "/frames/camera.0001.exr")); }

  /// Relative error that a configuration states. `matrix`: its error bound. `progressive`: the error by unshot light,
  /// residual / (1 - mean rho), plus the sampling error, estimated from a second solve with another seed.
  double stated_error(const Configuration& configuration, const std::string& output) {
    const PatchSet scene = read_patches(folder_ / (output + "/patches.h5"));
    const EnergyField energy = read_energy(folder_ / (output + "/energy.h5"), scene);
    if (energy.estimate) return energy.estimate->error_bound;
    const std::string again = output + ".again";
    run("patchlight-import", configuration, again);
    run("patchlight-solve", configuration, again, {"solve.seed=2", "solve.display=false"});
    const EnergyField other = read_energy(folder_ / (again + "/energy.h5"), scene);
    double reflected = 0, area = 0;
    for (const Patch& patch : scene.patches) {
      reflected += patch.area * patch.reflectance.y;
      area += patch.area;
    }
    return energy.residual / (1 - reflected / area) + radiosity_error(scene, energy, other) / std::sqrt(2.0);
  }
};

/// Mean block error by the noise of the reference, from the standard errors of its pixels.
double noise_of(const Image& deviation, const Image& reference) {
  constexpr int kBlock = 8;
  Vec3d mean(0.0);
  for (const Color& c : reference.pixels) mean += Vec3d(c) / double(reference.pixels.size());
  double sum = 0;
  int blocks = 0;
  for (int top = 0; top < reference.height; top += kBlock)
    for (int left = 0; left < reference.width; left += kBlock)
      for (int k = 0; k < 3; ++k, ++blocks) {
        double variance = 0, value = 0;
        for (int i = 0; i < kBlock * kBlock; ++i) {
          const int at = (top + i / kBlock) * reference.width + left + i % kBlock;
          variance += std::pow(deviation.pixels[std::size_t(at)][k], 2);
          value += reference.pixels[std::size_t(at)][k];
        }
        // The mean magnitude of a normal variable is sqrt(2 / pi) times its standard deviation.
        sum += std::sqrt(2 / kPi * variance) / (value + kBlock * kBlock * 0.01 * mean[k]);
      }
  return sum / blocks;
}

/// The block error of each configuration's frame against the path tracer is at most its stated error, plus the noise of
/// reference and frame, plus the discretisation error. Two frames share their noise and discretisation, so their
/// difference is at most the sum of their stated errors.
TEST_F(Configurations, AgreeWithThePathTracerAndEachOtherWithinTheirStatedErrors) {
  const Image reference = read_exr(kScenes + "/reference/cornell.exr");
  const double reference_noise = noise_of(read_exr(kScenes + "/reference/cornell.stderr.exr"), reference);
  std::array<double, 4> stated{};
  std::array<Image, 4> frames;
  double frame_noise = 0;
  for (std::size_t k = 0; k < kConfigurations.size(); ++k) {
    const std::string output = fmt::format("{}_{}", kConfigurations[k].method, kConfigurations[k].form_factors);
    run("patchlight", kConfigurations[k], output);
    frames[k] = frame(output);
    stated[k] = stated_error(kConfigurations[k], output);
    if (k == 0) {
      run("patchlight-trace", kConfigurations[k], output, {"trace.samples=256"});
      frame_noise = image_error(frames[0], frame(output)).block;
    }
    const double error = image_error(frames[k], reference).block;
    std::cout << fmt::format("{}: states {:.2f}%, block error {:.2f}%\n", output, 100 * stated[k], 100 * error);
    EXPECT_LT(stated[k], 0.03) << output << " states too large an error for a meaningful test";
    EXPECT_LE(error, stated[k] + reference_noise + frame_noise + kDiscretisationError) << output;
  }
  std::cout << fmt::format("noise of the reference {:.2f}%, of frames {:.2f}%\n", 100 * reference_noise,
                           100 * frame_noise);
  for (std::size_t a = 0; a < kConfigurations.size(); ++a)
    for (std::size_t b = a + 1; b < kConfigurations.size(); ++b) {
      const double difference = image_error(frames[a], frames[b]).block;
      std::cout << fmt::format("{} {} from {} {}: {:.2f}%\n", kConfigurations[a].method,
                               kConfigurations[a].form_factors, kConfigurations[b].method,
                               kConfigurations[b].form_factors, 100 * difference);
      EXPECT_LE(difference, stated[a] + stated[b]) << a << " from " << b;
    }
}

}  // namespace
}  // namespace patchlight::test
