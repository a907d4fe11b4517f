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
    app.add_flag(
        "--skip-fresh", skip_fresh,
        "Leave frames that are there as the job makes them now, and share the others with whoever renders them");
    CLI::Option* part = add_shard_option(app, shard, "Render every K-th frame alone, from the k-th on");
    app.add_flag(
           "--relight", relight,
           "Trace nothing: make frames under other `lights` from the layers `light_groups` of those that are there")
        ->excludes(part);
  });
}
