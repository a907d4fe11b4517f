#include <gtest/gtest.h>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/image/image_error.h"
#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kScenes = PATCHLIGHT_SCENES;

class Reference : public ProgramTest {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kScenes + "/reference/cornell.exr"))
      GTEST_SKIP() << "no reference scenes at " << kScenes;
  }
  void run(const std::string& scene, const std::string& more) {
    folder_.write("job.yaml", "scene: " + kScenes + "/blender/" + scene + ".glb\noutput: out\n" + more);
    const Outcome outcome = run_program(folder_, "patchlight", {"run", "job.yaml"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
};

TEST_F(Reference, CornellMatchesThePathTracerAtTheDefaults) {
  run("cornell", "trace: {resolution: [256, 256]}\n");
  const Image frame = read_exr(folder_ / "out/frames/camera.0001.exr");
  EXPECT_LT(image_error(frame, read_exr(kScenes + "/reference/cornell.exr")).block, 0.02);
}

struct Furnace {
  const char* scene;
  Vec3d radiance;  ///< Emissive x strength / (1 - rho).
};

class FurnaceReference : public Reference, public ::testing::WithParamInterface<Furnace> {};

TEST_P(FurnaceReference, MatchesTheClosedForm) {
  run(GetParam().scene, "trace: {resolution: [32, 32]}\n");
  const PatchSet scene = read_patches(folder_ / "out/patches.h5");
  const std::vector<Color> b = radiosity(scene, read_energy(folder_ / "out/energy.h5", scene));
  Vec3d sum(0.0);
  double area = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    sum += Vec3d(b[i]) * scene.patches[i].area;
    area += scene.patches[i].area;
  }
  Vec3d pixels(0.0);
  const Image image = read_exr(folder_ / "out/frames/camera.0001.exr");
  for (const Color& c : image.pixels) pixels += Vec3d(c) / double(image.pixels.size());
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sum[k] / area / kPi / GetParam().radiance[k], 1.0, 0.003);
    EXPECT_NEAR(pixels[k] / GetParam().radiance[k], 1.0, 0.01);
  }
}

INSTANTIATE_TEST_SUITE_P(All, FurnaceReference,
                         ::testing::Values(Furnace{"furnace_r050", {2, 1, 0.5}}, Furnace{"furnace_r090", {40, 20, 10}},
                                           Furnace{"sphere_furnace", {10, 4, 2.5}}),
                         [](const auto& furnace) { return std::string(furnace.param.scene); });

}  // namespace
}  // namespace patchlight::test
