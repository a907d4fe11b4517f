#include "pipeline/formats/solution/energy_file.h"

#include <gtest/gtest.h>

#include "tests/expect_error.h"
#include "tests/patch_scene.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::TemporaryFolder;

struct Solved {
  PatchSet scene;
  EnergyField energy;

  Solved() {
    test::PatchScene builder;
    builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 2, 1, {0.5f, 2.0f});
    scene = builder.get();
    energy.groups = {{"light", {Color(1.0f), Color(2.0f)}, {Color(0.5f), Color(0.25f)}}};
    energy.key = "key";
    energy.patches_key = scene.key;
    energy.rays = 1234567890123;
    energy.residual = 1e-4;
  }
};

TEST(EnergyFile, ReadsBackTheDisplaySolution) {
  const TemporaryFolder folder;
  Solved solved;
  DisplayMesh& mesh = solved.energy.display.emplace();
  mesh.roots = {-1, 0};
  mesh.cells.resize(1);
  mesh.cells[0].face = 0;
  mesh.faces = {{1, 0, 4, 1.0f, 1}};
  mesh.corners = {0, 0, 1, 1, 0};
  mesh.vertices = {{1, 0.5f, 0.0f}, {1, 0.5f, 1.0f}};
  mesh.gathered = 1;
  solved.energy.groups[0].display.assign(1, Color(0.75f));
  write_energy(folder / "energy.h5", solved.scene, solved.energy);
  const EnergyField read = read_energy(folder / "energy.h5", solved.scene);
  ASSERT_TRUE(read.display);
  EXPECT_EQ(read.display->corners, mesh.corners);
  EXPECT_EQ(read.display->middles_of(read.display->faces[0]).size(), 1u);
  EXPECT_EQ(read.groups[0].display, solved.energy.groups[0].display);
  EXPECT_TRUE(read_energy(folder / "energy.h5").display);
  solved.energy.display.reset();
  write_energy(folder / "energy.h5", solved.scene, solved.energy);
  EXPECT_FALSE(read_energy(folder / "energy.h5", solved.scene).display);
}

TEST(EnergyFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const Solved solved;
  write_energy(folder / "energy.h5", solved.scene, solved.energy);
  const EnergyField read = read_energy(folder / "energy.h5", solved.scene);
  EXPECT_EQ(read.groups[0].direct, solved.energy.groups[0].direct);
  EXPECT_EQ(read.groups[0].indirect, solved.energy.groups[0].indirect);
  EXPECT_EQ(read.rays, solved.energy.rays);
  EXPECT_EQ(read.residual, 1e-4);
  EXPECT_EQ(read_energy(folder / "energy.h5").groups[0].name, "light");
}

TEST(EnergyFile, ReadsBackTheEstimateOfItsError) {
  const TemporaryFolder folder;
  Solved solved;
  solved.energy.estimate = {0.01, 0.02, 0.003, 0.007, 0.4, 0.3, 0.005, 0.06, {Color(0.1f), Color(0.2f)}};
  write_energy(folder / "energy.h5", solved.scene, solved.energy);
  const EnergyField::Estimate read = read_energy(folder / "energy.h5", solved.scene).estimate.value();
  EXPECT_EQ(read.error, 0.01);
  EXPECT_EQ(read.error_bound, 0.02);
  EXPECT_EQ(read.error_residual, 0.003);
  EXPECT_EQ(read.error_local, 0.4);
  EXPECT_EQ(read.error_local_estimate, 0.3);
  EXPECT_EQ(read.balance, 0.005);
  EXPECT_EQ(read.reciprocity, 0.06);
  EXPECT_EQ(read.deviation, solved.energy.estimate->deviation);
}

TEST(EnergyFile, ReadsBackHowItCameToBe) {
  const TemporaryFolder folder;
  Solved solved;
  solved.energy.convergence = {{"light", {1, 0.1, 1.0 / 3}}, {"a b,c", {2}}, {"", {}}};
  solved.energy.made = {"scene: a.glb\n", {"one", "two"}, 1.5, 2.5, 12345678901};
  write_energy(folder / "energy.h5", solved.scene, solved.energy);
  const EnergyField read = read_energy(folder / "energy.h5", solved.scene);
  ASSERT_EQ(read.convergence.size(), 3u);
  EXPECT_EQ(read.convergence[0].residuals, solved.energy.convergence[0].residuals);
  EXPECT_EQ(read.convergence[1].group, "a b,c");
  EXPECT_TRUE(read.convergence[2].residuals.empty());
  EXPECT_EQ(read.made.job, solved.energy.made.job);
  EXPECT_EQ(read.made.warnings, solved.energy.made.warnings);
  EXPECT_EQ(read.made.cpu_seconds, 2.5);
  EXPECT_EQ(read.made.peak_bytes, 12345678901);
}

TEST(EnergyFile, HoldsRadiosityOfEmissionAndAllGroups) {
  const Solved solved;
  EXPECT_EQ(radiosity(solved.scene, solved.energy)[0], Color(2.0f + 0.5f * 1.5f));
}

TEST(EnergyFile, RadiosityErrorIsRelativeAndWithoutEmitters) {
  Solved solved;
  solved.scene.patches[0].area = 4;
  EnergyField other = solved.energy;
  other.groups[0].direct[0] *= 1.5f;  // of the emitter
  solved.scene.patches[1].emission = Color(0.0f);
  EXPECT_EQ(radiosity_error(solved.scene, other, solved.energy), 0);
  other.groups[0].direct[1] = Color(2.225f);  // irradiance 2.475 for 2.25
  EXPECT_NEAR(radiosity_error(solved.scene, other, solved.energy), 0.1, 1e-6);
}

TEST(EnergyFile, RefusesAnotherScene) {
  const TemporaryFolder folder;
  Solved solved;
  write_energy(folder / "energy.h5", solved.scene, solved.energy);
  solved.scene.key = "other";
  EXPECT_ERROR(read_energy(folder / "energy.h5", solved.scene), ExitCode::bad_data, "another patch file");
}

TEST(EnergyFile, RefusesNegativeIrradiance) {
  const TemporaryFolder folder;
  Solved solved;
  solved.energy.groups[0].direct[1].y = -1;
  write_energy(folder / "energy.h5", solved.scene, solved.energy);
  EXPECT_ERROR(read_energy(folder / "energy.h5", solved.scene), ExitCode::bad_data, "/groups/light/direct");
}

}  // namespace
}  // namespace patchlight
