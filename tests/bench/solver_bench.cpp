// Rays and hemicubes per CPU second inside the solver, and error against CPU seconds.

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "solver/form_factors/ray_form_factors.h"
#include "solver/hemicube/hemicube.h"
#include "solver/solve.h"
#include "tests/bench/bench_scene.h"

namespace patchlight {
namespace {

void solver_cast(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const RayFormFactors factors(bench_scene(), 1);
  std::vector<Shot> shots;
  for (std::int32_t i = 0; i < std::int32_t(bench_scene().patches.size()); ++i) shots.push_back({i, 256, 0});
  for (auto _ : state) benchmark::DoNotOptimize(factors.cast(shots));
  state.SetItemsProcessed(std::int64_t(state.iterations() * shots.size() * 256));
}
BENCHMARK(solver_cast)->Unit(benchmark::kMillisecond)->Repetitions(5)->ReportAggregatesOnly();

/// Rows of 2,000 evenly chosen patches; CPU seconds include the rasteriser's threads.
void hemicubes(benchmark::State& state) {
  HemicubeFormFactors factors(bench_scene(), int(state.range(0)), 1);
  const std::size_t count = std::min<std::size_t>(2000, bench_scene().patches.size());
  std::vector<Shot> shots;
  for (std::size_t k = 0; k < count; ++k)
    shots.push_back({std::int32_t(k * bench_scene().patches.size() / count), 0, 1});
  for (auto _ : state) {
    for (std::span<const Shot> remaining = shots; !remaining.empty();) {
      const std::span<const Shot> batch = remaining.first(factors.batch(remaining));
      benchmark::DoNotOptimize(factors.rows(batch));
      remaining = remaining.subspan(batch.size());
    }
  }
  state.counters["patches"] = double(bench_scene().patches.size());
  state.SetItemsProcessed(std::int64_t(state.iterations() * count));
}
BENCHMARK(hemicubes)
    ->Arg(128)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

SolveConfig config_of(int rays, double tolerance) {
  SolveConfig config;
  config.rays = rays;
  config.tolerance = tolerance;
  config.display = false;
  return config;
}

void solve_error(benchmark::State& state) {
  static const EnergyField truth = solve(bench_scene(), config_of(1 << 16, 1e-5), quiet());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EnergyField energy;
  for (auto _ : state) energy = solve(bench_scene(), config_of(int(state.range(0)), 1e-3), quiet());
  state.counters["patches"] = double(bench_scene().patches.size());
  state.counters["rays"] = double(energy.rays);
  state.counters["error_percent"] = 100 * radiosity_error(bench_scene(), energy, truth);
}
BENCHMARK(solve_error)->RangeMultiplier(4)->Range(16, 4096)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace patchlight

BENCHMARK_MAIN();
