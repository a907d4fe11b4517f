// Primary rays per CPU second of one thread: whole frames of quality `patches` at one sample a pixel against raw Embree
// on rays of the same camera. The scene is configs/cornell_box.glb, or $PATCHLIGHT_BENCH_SCENE; the camera its first.

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <xmmintrin.h>

#include <cstdlib>
#include <memory>

#include "importers/import.h"
#include "pipeline/frames/frame_list.h"
#include "solver/solve.h"
#include "tracer/light/integrator.h"
#include "tracer/sampling/camera_rays.h"

namespace patchlight {
namespace {

constexpr int kSide = 512;  // pixels

Progress& quiet() {
  static Progress progress({"bench", true, ""});
  return progress;
}

const Job& job() {
  static const Job patches = [] {
    Job job;
    const char* file = std::getenv("PATCHLIGHT_BENCH_SCENE");
    job.scene = file ? file : PATCHLIGHT_SOURCE "/configs/cornell_box.glb";
    job.solve.rays = 64;
    job.solve.display = false;
    job.trace.quality = "patches";
    job.trace.samples = 1;
    job.trace.resolution = {kSide, kSide};
    return job;
  }();
  return patches;
}

const PatchSet& scene() {
  static const PatchSet patches = import_scene(job(), quiet());
  return patches;
}

Camera camera() {
  return job_frames(job(), scene()).at(0).camera;
}

/// Traces packets of 16 adjacent pixels. Each is copied first, since tracing changes it.
void raw_primary(benchmark::State& state) {
  _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
  const RayScene embree(scene(), RayScene::Tracer::embree);
  const CameraRays rays(camera(), kSide, kSide);
  constexpr int kPackets = kSide * kSide / RayPacket::kSize;
  const auto packets = std::make_unique<RayPacket[]>(kPackets);
  for (int k = 0; k < kPackets; ++k) {
    ImagePoints points;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const int pixel = k * RayPacket::kSize + lane;
      points.x[lane] = float(pixel % kSide) + 0.5f;
      points.y[lane] = float(pixel / kSide) + 0.5f;
    }
    rays.generate(points, embree, packets[k]);
  }
  for (auto _ : state)
    for (int k = 0; k < kPackets; ++k) {
      RayPacket packet = packets[k];
      embree.intersect(packet, true);
      benchmark::DoNotOptimize(packet);
    }
  state.SetItemsProcessed(std::int64_t(state.iterations()) * kSide * kSide);
}
BENCHMARK(raw_primary)->Unit(benchmark::kMillisecond)->Repetitions(9)->ReportAggregatesOnly();

/// Renders a frame of a loaded scene, without writing files.
void frames(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const EnergyField energy = solve(scene(), job().solve, quiet());
  const Integrator integrator(scene(), energy, job());
  for (auto _ : state) benchmark::DoNotOptimize(integrator.render(camera(), quiet()));
  state.SetItemsProcessed(std::int64_t(state.iterations()) * kSide * kSide);
}
BENCHMARK(frames)->Unit(benchmark::kMillisecond)->Repetitions(9)->ReportAggregatesOnly();

}  // namespace
}  // namespace patchlight

BENCHMARK_MAIN();
