#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <span>

#include "pipeline/image/image_file.h"
#include "solver/solve.h"
#include "tests/end_to_end/accuracy/light_scenes.h"
#include "tracer/light/integrator.h"

namespace patchlight::test {
namespace {

struct Kind {
  const char* name;
  LitScene (*make)(int fine);
  double pixels, blocks;  ///< Largest errors.

  friend void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }
};

class LightFrames : public ::testing::TestWithParam<Kind> {
 protected:
  static constexpr int kBlock = 6;  // pixels

  static std::vector<std::int32_t> emitters_of(LitScene& lit) {
    std::vector<std::int32_t> emitters;
    const auto& primitives = lit.builder.get().primitives;
    for (std::int32_t i = 0; i < std::int32_t(primitives.size()); ++i)
      if (primitives[i].light_group >= 0) emitters.push_back(i);
    return emitters;
  }

  /// The scene with only these emitting primitives.
  static LitScene with_only(LitScene lit, std::span<const std::int32_t> emitters) {
    PatchSet& scene = lit.builder.get();
    for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i)
      if (std::find(emitters.begin(), emitters.end(), i) == emitters.end()) scene.primitives[i].light_group = -1;
    for (Patch& patch : scene.patches)
      if (scene.primitives[patch.primitive].light_group < 0) patch.emission = Color(0.0f);
    return lit;
  }

  static Image render(LitScene lit, const SolveConfig& config, const TraceConfig& trace, Transport& transport) {
    const PatchSet& scene = lit.builder.get();
    Progress progress({"test", true, ""});
    Job job;
    job.trace = trace;
    job.trace.resolution = {96, 72};
    return Integrator(scene, solve(scene, config, transport, progress), job).render(lit.camera, progress);
  }

  std::filesystem::path reference() const {
    return std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/light/" + GetParam().name + ".exr";
  }

  /// Root mean square of the difference between means of blocks of pixels, over that of the reference.
  static double error(const Image& image, const Image& exact, int block) {
    double squares = 0, all = 0;
    for (int y = 0; y < image.height; y += block)
      for (int x = 0; x < image.width; x += block) {
        Vec3d difference(0.0), sum(0.0);
        for (int k = 0; k < block * block; ++k) {
          const std::size_t at = std::size_t(y + k / block) * image.width + x + k % block;
          difference += Vec3d(image.pixels[at]) - Vec3d(exact.pixels[at]);
          sum += Vec3d(exact.pixels[at]);
        }
        squares += difference.length2();
        all += sum.length2();
      }
    return std::sqrt(squares / all);
  }
};

/// Makes the references, by many rays and small patches, in half an hour:
/// `end_to_end_test --gtest_also_run_disabled_tests --gtest_filter='*MakeReference*'`. Up to `kSmall` emitters, which
/// rays would rarely hit, are solved for in groups of few, which need no light tree, and added up.
TEST_P(LightFrames, DISABLED_MakeReference) {
  constexpr std::size_t kAtOnce = 60, kSmall = 1000;
  SolveConfig config;
  config.rays = 8192;
  config.tolerance = 1e-5;
  TraceConfig trace;
  trace.quality = "gather";
  trace.samples = 256;
  LitScene lit = GetParam().make(2);
  const std::size_t all = emitters_of(lit).size();
  const std::size_t at_once = all > kSmall ? all : kAtOnce;
  if (all > kSmall) {
    config.rays = 1024;
    trace.samples = 64;
  }
  if (all > at_once) {
    trace.quality = "direct";
    config.rays = 2048;
  }
  const std::vector<std::int32_t> emitters = emitters_of(lit);
  Transport transport;
  Image sum = render(with_only(lit, std::span(emitters).first(std::min(all, at_once))), config, trace, transport);
  for (std::size_t done = at_once; done < all; done += at_once) {
    const auto some = std::span(emitters).subspan(done, std::min(at_once, all - done));
    const Image image = render(with_only(lit, some), config, trace, transport);
    for (std::size_t k = 0; k < sum.pixels.size(); ++k) sum.pixels[k] += image.pixels[k];
  }
  std::filesystem::create_directories(reference().parent_path());
  write_exr(reference(), sum);
}

TEST_P(LightFrames, AreRightAtDefaultSettings) {
  Transport transport;
  const Image exact = read_exr(reference()), image = render(GetParam().make(1), {}, {}, transport);
  EXPECT_LT(error(image, exact, 1), GetParam().pixels);
  EXPECT_LT(error(image, exact, kBlock), GetParam().blocks);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LightFrames,
                         ::testing::Values(Kind{"blinds", blinds, 0.08, 0.02},
                                           Kind{"lampshade", lampshade, 0.012, 0.004},
                                           Kind{"street", street, 0.035, 0.012}, Kind{"window", window, 0.03, 0.02},
                                           Kind{"leaves", leaves, 0.03, 0.006}, Kind{"cones", cones, 0.02, 0.01},
                                           Kind{"perforated", perforated, 0.04, 0.012},
                                           Kind{"bulbs", bulbs, 0.06, 0.02}, Kind{"strip", strip, 0.05, 0.015},
                                           Kind{"screen", screen, 0.06, 0.012}, Kind{"city", city, 0.08, 0.02}),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace patchlight::test
