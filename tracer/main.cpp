#include <CLI/CLI.hpp>
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
  return run_stage("trace", argc, argv, body, [&](CLI::App& app) {
    app.add_flag("--skip-fresh", skip_fresh,
                 "Skip frames that are up to date, and share the others with processes that render the same job");
    CLI::Option* shard_option = add_shard_option(app, shard, "Render only frames k, k + K, k + 2K, ...");
    app.add_flag("--relight", relight,
                 "Trace nothing: make frames under other `lights` from the layers `light_groups` of existing frames")
        ->excludes(shard_option);
  });
}
