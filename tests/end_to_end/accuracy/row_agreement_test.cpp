#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/formats/patches/patch_file.h"
#include "solver/form_factors/ray_form_factors.h"
#include "solver/hemicube/hemicube.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kScenes = PATCHLIGHT_SCENES;

/// Compares rows of form factors by hemicubes with rows by rays, patch by patch, in scenes exported by Blender.
class RowAgreement : public ::testing::TestWithParam<const char*> {};

TEST_P(RowAgreement, HoldsPatchByPatch) {
  const std::string file = kScenes + "/blender/" + GetParam() + ".glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no scene " << file;
  const TemporaryFolder folder;
  folder.write("job.yaml", "scene: " + file + "\noutput: out\n");
  ASSERT_EQ(run_program(folder, "patchlight-import", {"job.yaml"}).code, 0);
  const PatchSet scene = read_patches(folder / "out/patches.h5");
  HemicubeFormFactors hemicubes(scene, 128, 1);
  RayFormFactors rays(scene, 1);
  constexpr std::uint32_t kRays = 1 << 16;
  // Of a surface 1 mm above, only hemicubes within a millimetre of it see much: one in 150 in gallery.
  constexpr int kHemicubes = 1024, kRows = 24;
  for (int k = 0; k < kRows; ++k) {
    const auto i = std::int32_t(k * scene.patches.size() / kRows);
    std::vector<double> by_hemicubes(scene.patches.size()), by_rays(scene.patches.size());
    for (int shot = 0; shot < kHemicubes; ++shot) {
      const Shot from{i, 0, std::uint64_t(shot)};
      const std::span<const FormFactor> row = hemicubes.rows({&from, 1})[0];
      for (const FormFactor& f : row) by_hemicubes[f.patch] += f.value / kHemicubes;
    }
    const Shot from{i, kRays, 0};
    const std::span<const FormFactor> row = rays.rows({&from, 1})[0];
    for (const FormFactor& f : row) by_rays[f.patch] += f.value;
    double escaped_by_rays = 1, escaped_by_hemicubes = 1;
    for (std::size_t j = 0; j < by_rays.size(); ++j) {
      // Five standard errors of the rays, plus the error of the hemicubes, each exact to one cell.
      const double tolerance = 5 * std::sqrt((by_rays[j] + 1.0 / kRays) / kRays) + 0.1 * by_rays[j] + 5e-4;
      EXPECT_NEAR(by_hemicubes[j], by_rays[j], tolerance) << i << " to " << j;
      escaped_by_rays -= by_rays[j];
      escaped_by_hemicubes -= by_hemicubes[j];
    }
    EXPECT_NEAR(escaped_by_hemicubes, escaped_by_rays, 0.02) << "escaped from " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RowAgreement, ::testing::Values("cornell", "gallery"),
                         [](const auto& scene) { return std::string(scene.param); });

}  // namespace
}  // namespace patchlight::test
