// Rays per CPU second inside the solver against raw Embree, hemicubes per CPU second, and error against CPU seconds.
// The scene is configs/cornell_box.glb, or $PATCHLIGHT_BENCH_SCENE; $PATCHLIGHT_BENCH_AREA sets the patch area in m2.

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <memory>
#include <random>

#include "importers/import.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "solver/form_factors/ray_form_factors.h"
#include "solver/form_factors/ray_rows.h"
#include "solver/hemicube/hemicube.h"
#include "solver/solve.h"
#include "tests/bench/plain_embree.h"

namespace patchlight {
namespace {

Progress& quiet() {
  static Progress progress({"bench", true, ""});
  return progress;
}

const PatchSet& scene() {
  static const PatchSet patches = [] {
    Job job;
    const char* file = std::getenv("PATCHLIGHT_BENCH_SCENE");
    const char* area = std::getenv("PATCHLIGHT_BENCH_AREA");
    job.scene = file ? file : PATCHLIGHT_SOURCE "/configs/cornell_box.glb";
    if (area) job.import.patch_area = std::atof(area);
    return import_scene(job, quiet());
  }();
  return patches;
}

constexpr std::size_t kPackets = 1 << 14;

/// Cosine-distributed rays from random points of all patches, in the coordinates of `rays`.
std::unique_ptr<RayPacket[]> random_packets(const RayScene& rays) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  auto packets = std::make_unique<RayPacket[]>(kPackets);
  for (std::size_t k = 0; k < kPackets; ++k) {
    const Patch& patch = scene().patches[k * scene().patches.size() / kPackets];
    const PatchSampler sample(scene().primitives, patch);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfacePoint point = sample(unit(random), unit(random));
      Vec3f tangent, bitangent;
      orthonormal_frame(point.normal, tangent, bitangent);
      const Vec3f d = cosine_direction(unit(random), unit(random));
      packets[k].set(lane, rays.to_local(point.position) + point.normal * rays.offset(patch.primitive),
                     tangent * d.x + bitangent * d.y + point.normal * d.z);
    }
  }
  return packets;
}

/// Random packets traced by Embree or by the PacketTracer, with the patch of each hit.
void raw_rays(benchmark::State& state) {
  const RayScene rays(scene(), state.range(0) != 0 ? RayScene::Tracer::embree : RayScene::Tracer::packets);
  const PatchLookup lookup(scene());
  const auto packets = random_packets(rays);
  std::int64_t sum = 0;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kPackets; ++k) {
      RayPacket packet = packets[k];
      rays.intersect(packet, false);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const SurfaceHit hit = rays.hit(packet, lane);
        sum += hit.front ? lookup.patch(hit.primitive, hit.u, hit.v) : -1;
      }
    }
  }
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(std::int64_t(state.iterations() * kPackets * RayPacket::kSize));
}
BENCHMARK(raw_rays)
    ->ArgName("embree")
    ->Arg(1)
    ->Arg(0)
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

/// The same rays traced by plain Embree: triangles, packets of 8 or 16, no patch lookup.
void plain_embree(benchmark::State& state) {
  const RayScene rays(scene());
  const auto packets = random_packets(rays);
  PlainEmbree embree(triangles_of(scene(), rays));
  std::vector<EmbreeRay> list;
  for (std::size_t k = 0; k < kPackets; ++k)
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      list.push_back({packets[k].origin(lane), packets[k].direction(lane)});
  for (auto _ : state) benchmark::DoNotOptimize(embree.count_hits(list, int(state.range(0))));
  state.SetItemsProcessed(std::int64_t(state.iterations() * list.size()));
}
BENCHMARK(plain_embree)
    ->ArgName("width")
    ->Arg(8)
    ->Arg(16)
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

void solver_cast(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const RayFormFactors factors(scene(), 1);
  std::vector<Shot> shots;
  for (std::int32_t i = 0; i < std::int32_t(scene().patches.size()); ++i) shots.push_back({i, 256, 0});
  for (auto _ : state) benchmark::DoNotOptimize(factors.cast(shots));
  state.SetItemsProcessed(std::int64_t(state.iterations() * shots.size() * 256));
}
BENCHMARK(solver_cast)->Unit(benchmark::kMillisecond)->Repetitions(5)->ReportAggregatesOnly();

/// All rows with 256 rays each, with the argument's number of threads; items are rays.
void rows_cast(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, std::size_t(state.range(0)));
  const RayScene ray_scene(scene());
  Progress progress({"bench", true, ""});
  std::int64_t rays = 0;
  for (auto _ : state) {
    Transport transport;
    rays += RayRows(scene(), ray_scene, scene().patches, Elements(scene()), 1).cast(256, transport, progress);
    benchmark::DoNotOptimize(transport.columns.data());
  }
  state.SetItemsProcessed(rays);
}
BENCHMARK(rows_cast)
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

/// Rows of 2,000 evenly chosen patches; CPU seconds include the rasteriser's threads.
void hemicubes(benchmark::State& state) {
  HemicubeFormFactors factors(scene(), int(state.range(0)), 1);
  const std::size_t count = std::min<std::size_t>(2000, scene().patches.size());
  std::vector<Shot> shots;
  for (std::size_t k = 0; k < count; ++k) shots.push_back({std::int32_t(k * scene().patches.size() / count), 0, 1});
  for (auto _ : state) {
    for (std::span<const Shot> remaining = shots; !remaining.empty();) {
      const std::span<const Shot> batch = remaining.first(factors.batch(remaining));
      benchmark::DoNotOptimize(factors.rows(batch));
      remaining = remaining.subspan(batch.size());
    }
  }
  state.counters["patches"] = double(scene().patches.size());
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
  static const EnergyField truth = solve(scene(), config_of(1 << 16, 1e-5), quiet());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EnergyField energy;
  for (auto _ : state) energy = solve(scene(), config_of(int(state.range(0)), 1e-3), quiet());
  state.counters["patches"] = double(scene().patches.size());
  state.counters["rays"] = double(energy.rays);
  state.counters["error_percent"] = 100 * radiosity_error(scene(), energy, truth);
}
BENCHMARK(solve_error)->RangeMultiplier(4)->Range(16, 4096)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace patchlight

BENCHMARK_MAIN();
