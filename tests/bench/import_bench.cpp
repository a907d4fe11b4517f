// CPU time of an import by number of triangles: smooth hills, and a flat floor whose triangles are merged.

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <fstream>

#include "pipeline/system/large_pages.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// GLB of a square grid of about this many triangles.
std::string floor_of(std::int64_t triangles, bool hills) {
  const auto n = std::uint32_t(std::lround(std::sqrt(double(triangles) / 2)));
  Mesh mesh = grid(n);
  for (Vec3f& p : mesh.positions) {
    if (!hills) continue;
    p.z = 3 * std::sin(p.x * 0.2f) * std::cos(p.y * 0.3f);
    const Vec3f slope(-0.6f * std::cos(p.x * 0.2f) * std::cos(p.y * 0.3f),
                      0.9f * std::sin(p.x * 0.2f) * std::sin(p.y * 0.3f), 1.0f);
    mesh.normals.push_back(slope.normalized());
  }
  return single_mesh(mesh).glb();
}

void import_floor(benchmark::State& state, bool hills) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "patchlight_import_bench.glb";
  {
    std::ofstream stream(file, std::ios::binary);
    stream << floor_of(state.range(0), hills);
  }
  Job job;
  job.scene = file;
  job.import.max_patches = 10'000'000;
  Progress progress({.stage = "bench", .quiet = true, .log_json_file = ""});
  for (auto _ : state) benchmark::DoNotOptimize(import_scene(job, progress));
  std::filesystem::remove(file);
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  state.counters["peak_MiB"] = double(use.ru_maxrss) / 1024;
  state.counters["triangles_per_s"] =
      benchmark::Counter(double(state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
  state.SetComplexityN(state.range(0));
}

BENCHMARK_CAPTURE(import_floor, hills, true)
    ->Arg(10'000)
    ->Arg(100'000)
    ->Arg(300'000)
    ->Arg(1'000'000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);
BENCHMARK_CAPTURE(import_floor, flat, false)
    ->Arg(10'000)
    ->Arg(100'000)
    ->Arg(300'000)
    ->Arg(1'000'000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);

}  // namespace
}  // namespace patchlight::test

int main(int argc, char** argv) {
  patchlight::use_large_pages();  // as the programs do
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
