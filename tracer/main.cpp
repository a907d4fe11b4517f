#include <optional>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/stage/stage.h"
#include "tracer/output/relight.h"
#include "tracer/trace.h"

int main(int argc, char** argv) {
  using namespace patchlight;
  bool skip_fresh = false, relight = false;
  std::optional<Shard> shard;
  const auto body = [&](const Job& job, Progress& progress) {
    const PatchSet scene = read_patches(job.patch_file());
    if (relight) return relight_frames(job, scene, skip_fresh, progress);
    trace_frames(job, scene, read_energy(job.energy_file(), scene), skip_fresh, shard.value_or(Shard()), progress);
  };
  return run_stage(
      "trace", argc, argv, body,
      {{.name = "--skip-fresh",
        .value = &skip_fresh,
        .help = "Skip frames that are up to date, and share the others with processes that render the same job"},
       {.name = "--shard", .value = &shard, .help = "Render only frames k, k + K, k + 2K, ..."},
       {.name = "--relight",
        .value = &relight,
        .help = "Trace nothing: make frames under other `lights` from the layers `light_groups` of existing frames",
        .excludes = "--shard"}});
}
