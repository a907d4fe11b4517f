#include <fmt/format.h>

#include <optional>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/job/job_check.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/stage/stage.h"
#include "solver/solve.h"
#include "solver/transport/existing_transport.h"
#include "solver/transport/transport_shards.h"

namespace {

using namespace patchlight;

/// Casts a shard of the rows unless its file is up to date.
void cast_shard(const Job& job, const PatchSet& scene, Shard shard, Progress& progress) {
  check_shardable(job);
  if (scene.light_groups.empty()) return progress.note("nothing in the scene emits light: no row is needed");
  const std::filesystem::path file = transport_shard_file(job, shard);
  const std::string key = transport_shard_key(job, scene, shard);
  if (is_fresh_shard(file, key)) return progress.note(file.filename().string() + " is up to date");
  TransportShard cast = cast_transport_shard(scene, job.solve, shard, progress);
  cast.key = key;
  cast.made = provenance(job, progress);
  write_transport_shard(file, cast);
  progress.note(fmt::format("{}: {} rows, {:.3g} million rays, {:.2f} s", file.filename().string(), cast.rows.rows(),
                            double(cast.cast) * 1e-6, progress.seconds()));
}

/// Solves with the rows of an earlier solve or, unless 0, of `shards` shards.
void solve_job(const Job& job, const PatchSet& scene, int shards, Progress& progress) {
  if (shards > 0) check_shardable(job);
  Transport transport = read_existing_transport(job, scene, progress);
  std::int64_t cast = 0;
  if (shards > 0 && transport.key.empty() && !scene.light_groups.empty())
    transport = merge_transport_shards(job, scene, shards, cast, progress);
  EnergyField energy = solve(scene, job.solve, transport, progress);
  energy.rays += cast;
  energy.made = transport.made = provenance(job, progress);
  if (transport.changed && job.solve.method == "matrix") write_transport(job.transport_file(), transport);
  write_energy(job.energy_file(), scene, energy);
  std::error_code ignored;  // transport.h5 now has all rows of the shards
  if (shards > 0)
    for (const std::filesystem::path& file : transport_shard_files(job)) std::filesystem::remove(file, ignored);
}

}  // namespace

int main(int argc, char** argv) {
  std::optional<Shard> shard;
  int shards = 0;
  const auto body = [&](const Job& job, Progress& progress) {
    const PatchSet scene = read_patches(job.patch_file());
    if (shard)
      cast_shard(job, scene, *shard, progress);
    else
      solve_job(job, scene, shards, progress);
  };
  return run_stage(
      "solve", argc, argv, body,
      {{.name = "--shard",
        .value = &shard,
        .help = "Only cast part k of K of the rows of form factors into transport.k-of-K.h5, unless it is up to date"},
       {.name = "--merge",
        .value = &shards,
        .help = "Merge the rows of this number of shards instead of casting them",
        .range = {{1, kMaxShards}},
        .excludes = "--shard"}});
}
