#include "pipeline/job/reader/job_reader.h"
#include "tests/pipeline/job/job_file.h"

namespace patchlight {
namespace {

using test::JobFile;
using test::kMinimal;

TEST_F(JobFile, ReadsAMatrixOfVariants) {
  const Job job = read(std::string(kMinimal) +
                       "matrix: {solve.rays: [64, 128], mood: {day: {}, night: {lights.\"a.b\".scale: 0}}}\n");
  ASSERT_EQ(job.matrix.size(), 2u);
  EXPECT_EQ(job.matrix[0].choices[1].name, "128");
  EXPECT_EQ(job.matrix[0].choices[1].settings[0], std::pair(std::string("solve.rays"), std::string("128")));
  EXPECT_EQ(job.matrix[1].choices[0].settings.size(), 0u);
  EXPECT_EQ(job.matrix[1].choices[1].settings[0], std::pair(std::string("lights.\"a.b\".scale"), std::string("0")));
  std::string many = std::string(kMinimal) + "matrix: {";
  for (const char* key : {"solve.rays", "solve.seed", "solve.max_shots", "trace.samples", "trace.fps"})
    many += std::string(key) + ": [1, 2, 3, 4, 5, 6, 7, 8], ";
  EXPECT_ERROR(read(many + "}\n"), ExitCode::bad_config, "at most 10000 combinations");
}

TEST_F(JobFile, MakesTheJobsThatItIsReadAs) {
  folder_.write("base.yaml", "materials: {red: {reflectance: [0.5, 0, 0]}}\n");
  const std::string text = std::string(kMinimal) + "matrix: {solve.rays: [64, 128]}\n";
  for (const std::string include : {"", "include: base.yaml\n"}) {
    const auto file = folder_.write("job.yaml", include + text);
    JobTemplate once(file);
    const std::vector<std::vector<std::string>> overrides{
        {}, {"solve.rays=9", "scene=other.glb"}, {"materials={blue: {patch_area: 1}}"}};
    for (const auto& sets : overrides)
      EXPECT_EQ(effective_job(once.job(sets, "out")), effective_job(read_job(file, sets, "out")));
    EXPECT_ERROR(once.job({"solve.rais=9"}, ""), ExitCode::bad_config, "solve.rays");
    once.drop_matrix();
    EXPECT_TRUE(once.job({}, "").matrix.empty());
  }
}

TEST_F(JobFile, ReadsASweepOfAnyKeys) {
  const Job job = read(std::string(kMinimal) + R"(
bench:
  sweep:
    - {solve.rays: [16, 64], import.patch_area: [1e-3, 4e-4]}
    - {trace.resolution: [[8, 8], [16, 16]], lights."lights.lamp".scale: 2}
  reference: truth.exr
  reference_settings: {solve.rays: 99}
)");
  ASSERT_EQ(job.bench.sweep.size(), 2u);
  EXPECT_EQ(job.bench.sweep[0][1].key, "import.patch_area");
  EXPECT_EQ(job.bench.sweep[0][1].values, (std::vector<std::string>{"1e-3", "4e-4"}));
  EXPECT_EQ(job.bench.sweep[1][0].values, (std::vector<std::string>{"[8, 8]", "[16, 16]"}));
  EXPECT_EQ(job.bench.sweep[1][1].key, "lights.\"lights.lamp\".scale");
  EXPECT_EQ(job.bench.reference, folder_ / "truth.exr");
  EXPECT_EQ(job.bench.reference_settings.at("solve.rays"), "99");
  EXPECT_EQ(job.bench.reference_settings.at("trace.samples"), "64");
  EXPECT_EQ(effective_job(read(effective_job(job))), effective_job(job));
  EXPECT_EQ(read(kMinimal, {"bench.sweep={solve.rays: [1]}"}).bench.sweep[0][0].values[0], "1");
}

TEST_F(JobFile, NamesTheLineOfABadSweptKeyOrValue) {
  const auto bench = [&](const std::string& text) { return read(std::string(kMinimal) + "bench:\n" + text); };
  EXPECT_ERROR(bench("  sweep:\n    - {solve.rays: [1]}\n    - {solve.ray: [1]}\n"), ExitCode::bad_config,
               "line 6): did you mean `solve.rays`?");
  EXPECT_ERROR(bench("  sweep:\n    solve.tolerance: [0.1]\n    solve.rays: [64, few]\n"), ExitCode::bad_config,
               "line 6): expected a whole number");
  EXPECT_ERROR(bench("  sweep: [{output: [a, b]}]\n"), ExitCode::bad_config, "`output` cannot vary");
  EXPECT_ERROR(bench("  sweep: [{solve..rays: 1}]\n"), ExitCode::bad_config, "line 4");
  EXPECT_ERROR(bench("  sweep: [{solve.rays: []}]\n"), ExitCode::bad_config, "at least one value");
  EXPECT_ERROR(bench("  sweep: 3\n"), ExitCode::bad_config, "line 4");
  EXPECT_ERROR(bench("  reference_settings: {solve.speed: 1}\n"), ExitCode::bad_config, "unknown key `solve.speed`");
  EXPECT_ERROR(bench("  reference: {radiance: [1, 2]}\n"), ExitCode::bad_config, "radiance");
  EXPECT_ERROR(bench("  repeats: 0\n"), ExitCode::bad_config, "bench.repeats");
  EXPECT_ERROR(bench("  swep: []\n"), ExitCode::bad_config, "did you mean `bench.sweep`?");
  EXPECT_ERROR(read(kMinimal, {"bench.sweep={solve.rays: [0]}"}), ExitCode::bad_config, "--set");
}

}  // namespace
}  // namespace patchlight
