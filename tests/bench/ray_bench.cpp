// Rays per CPU second of one thread: Patchlight's tracers and plain Embree on the same rays, and rows of form factors.

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/sampling/sobol.h"
#include "pipeline/optics/transport/elements.h"
#include "solver/form_factors/quad_rays.h"
#include "solver/form_factors/ray_rows.h"
#include "tests/bench/bench_scene.h"
#include "tests/bench/plain_embree.h"

namespace patchlight {
namespace {

constexpr std::size_t kRays = 1 << 18;
constexpr int kRowRays = 128;  // of a sample set, of the default 256 rays a row

/// Patches in runs of 16 that follow each other, as the solver casts their rows, spread over the scene.
std::vector<Patch> patches(std::size_t count) {
  const std::vector<Patch>& all = bench_scene().patches;
  std::vector<Patch> some;
  for (std::size_t k = 0; k < count; ++k)
    some.push_back(all[(k / 16 * 16 * std::max<std::size_t>(1, all.size() / count) + k % 16) % all.size()]);
  return some;
}

/// Rays as RayRows casts them: of a patch, with cosine-distributed directions, similar ones next to each other.
std::vector<EmbreeRay> row_rays(const RayScene& scene) {
  const DirectionTable table(kRowRays);
  std::vector<EmbreeRay> rays;
  for (const Patch& patch : patches(kRays / kRowRays)) {
    const PatchSampler sample(bench_scene().primitives, patch);
    std::array<std::uint32_t, 4> shift;
    for (std::size_t k = 0; k < 4; ++k) shift[k] = std::uint32_t(hash64(rays.size() + k));
    Vec3f tangent, bitangent;
    for (int first = 0; first < kRowRays; first += RayPacket::kSize) {
      QuadSamples s;
      shift_samples(table, first, shift, s);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const SurfacePoint point = sample(s.u[lane], s.v[lane]);
        orthonormal_frame(point.normal, tangent, bitangent);
        rays.push_back({scene.to_local(point.position) + point.normal * scene.offset(patch.primitive),
                        tangent * s.dx[lane] + bitangent * s.dy[lane] + point.normal * s.dz[lane]});
      }
    }
  }
  return rays;
}

/// Rays of 16 cameras of 128 x 128 pixels and an angle of 90 degrees, each at a patch, 4 x 4 pixels at a time.
std::vector<EmbreeRay> camera_rays(const RayScene& scene) {
  constexpr int kCameras = 16, kTiles = 32;
  std::vector<EmbreeRay> rays;
  for (std::size_t camera = 0; camera < kCameras; ++camera) {
    const Patch& patch = bench_scene().patches[camera * bench_scene().patches.size() / kCameras];
    const Vec3f eye = scene.to_local(patch.center) + patch.normal * scene.offset(patch.primitive);
    Vec3f tangent, bitangent;
    orthonormal_frame(patch.normal, tangent, bitangent);
    for (int tile = 0; tile < kTiles * kTiles; ++tile)
      for (int pixel = 0; pixel < RayPacket::kSize; ++pixel) {
        const float x = (float(tile % kTiles * 4 + pixel % 4) + 0.5f) / (2 * kTiles) - 1.0f;
        const float y = (float(tile / kTiles * 4 + pixel / 4) + 0.5f) / (2 * kTiles) - 1.0f;
        rays.push_back({eye, (tangent * x + bitangent * y + patch.normal).normalized()});
      }
  }
  return rays;
}

enum Rays { kRows, kCamera };

std::vector<EmbreeRay> rays_of(std::int64_t rays, const RayScene& scene) {
  return rays == kCamera ? camera_rays(scene) : row_rays(scene);
}

std::int64_t count_hits(const std::vector<EmbreeRay>& rays, const RayScene& scene, bool coherent) {
  std::int64_t hits = 0;
  for (std::size_t first = 0; first < rays.size(); first += RayPacket::kSize) {
    RayPacket packet;
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      packet.set(lane, rays[first + lane].origin, rays[first + lane].direction);
    scene.intersect(packet, coherent);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) hits += packet.rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

void report(benchmark::State& state, std::int64_t hits) {
  state.counters["hits"] = double(hits) / double(kRays);
  state.counters["primitives"] = double(bench_scene().primitives.size());
  state.SetItemsProcessed(std::int64_t(state.iterations() * kRays));
}

/// The scene for a tracer, built once.
const RayScene& ray_scene(RayScene::Tracer tracer) {
  static std::array<std::unique_ptr<RayScene>, 3> scenes;
  std::unique_ptr<RayScene>& scene = scenes[std::size_t(tracer)];
  if (!scene) scene = std::make_unique<RayScene>(bench_scene(), tracer);
  return *scene;
}

/// Patchlight's tracers: its packets, which take no notice of `coherent`, or Embree as it uses it.
void raw_rays(benchmark::State& state) {
  _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
  const RayScene& scene = ray_scene(state.range(1) != 0 ? RayScene::Tracer::embree : RayScene::Tracer::packets);
  const std::vector<EmbreeRay> rays = rays_of(state.range(0), scene);
  std::int64_t hits = 0;
  for (auto _ : state) benchmark::DoNotOptimize(hits = count_hits(rays, scene, state.range(2) != 0));
  report(state, hits);
}
BENCHMARK(raw_rays)
    ->ArgNames({"camera", "embree", "coherent"})
    ->ArgsProduct({{kRows, kCamera}, {0}, {0}})
    ->ArgsProduct({{kRows, kCamera}, {1}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

/// Plain Embree, built once for runs of the same variant.
const PlainEmbree& plain(std::int64_t variant) {
  static std::optional<PlainEmbree> embree;
  static std::int64_t built = -1;
  if (built != variant)
    embree.emplace(bench_scene(), ray_scene(RayScene::Tracer::fastest), PlainEmbree::Variant(built = variant));
  return *embree;
}

/// The same rays traced by plain Embree.
void plain_embree(benchmark::State& state) {
  _mm_setcsr(_mm_getcsr() | 0x8040);
  const std::vector<EmbreeRay> rays = rays_of(state.range(3), ray_scene(RayScene::Tracer::fastest));
  const PlainEmbree& embree = plain(state.range(0));
  std::int64_t hits = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(hits = embree.count_hits(rays, int(state.range(1)), state.range(2) != 0));
  report(state, hits);
}
BENCHMARK(plain_embree)
    ->ArgNames({"variant", "width", "coherent", "camera"})
    ->ArgsProduct({{0, 1, 2, 3, 4}, {8, 16}, {0, 1}, {kRows, kCamera}})
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

/// Rows of up to 8,192 patches with 256 rays each, with the argument's number of threads; items are rays.
void rows_cast(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, std::size_t(state.range(0)));
  const RayScene& scene = ray_scene(RayScene::Tracer::fastest);
  const std::vector<Patch> receivers = patches(std::min<std::size_t>(8192, bench_scene().patches.size()));
  const Elements elements(bench_scene());
  std::int64_t rays = 0;
  for (auto _ : state) {
    Transport transport;
    rays += RayRows(bench_scene(), scene, receivers, elements, 1).cast(2 * kRowRays, transport, quiet());
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

}  // namespace
}  // namespace patchlight
