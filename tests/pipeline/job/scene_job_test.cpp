#include "tests/pipeline/job/job_file.h"

namespace patchlight::test {
namespace {

TEST_F(JobFile, IsReplacedByASceneWithAllDefaults) {
  for (const char* name : {"room.glb", "room.GLTF", "a.b.glb"}) {
    const std::filesystem::path scene = folder_.write(name, "whatever");
    const Job job = read_job(scene);
    EXPECT_EQ(job.scene, scene);
    EXPECT_EQ(job.output, folder_.path() / (scene.stem().string() + ".patchlight"));
    EXPECT_EQ(read(effective_job(job)).scene, scene);
    EXPECT_EQ(job.solve.rays, Job().solve.rays);
  }
}

TEST_F(JobFile, TakesOverridesForASceneToo) {
  const std::filesystem::path scene = folder_.write("room.glb", "whatever");
  const Job job = read_job(scene, {"solve.rays=7", "environment.image=sky.exr", "output=there"});
  EXPECT_EQ(job.solve.rays, 7);
  EXPECT_EQ(job.environment.image, folder_ / "sky.exr");
  EXPECT_EQ(job.output, folder_ / "there");
  EXPECT_EQ(read_job(scene, {}, "/elsewhere").output, "/elsewhere");
  EXPECT_ERROR(read_job(scene, {"solve.rais=7"}), ExitCode::bad_config, "did you mean `solve.rays`?");
}

TEST_F(JobFile, IsNotReplacedByASceneThatIsMissing) {
  EXPECT_ERROR(read_job(folder_ / "none.glb"), ExitCode::missing_input, "missing scene");
}

}  // namespace
}  // namespace patchlight::test
