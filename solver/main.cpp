#include <malloc.h>

#include "pipeline/files/energy_file.h"
#include "pipeline/files/key.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/files/transport_file.h"
#include "pipeline/model/error.h"
#include "pipeline/stage/stage.h"
#include "solver/solve.h"

namespace {

using namespace patchlight;

/// What an earlier solve left, if it is whole and of this scene.
Transport read_kept(const Job& job, const PatchSet& scene, Progress& progress) {
  std::error_code fault;
  if (job.solve.method != "matrix" || !std::filesystem::exists(job.transport_file(), fault)) return {};
  try {
    std::optional<Transport> kept = read_transport(job.transport_file(), transport_key(scene.geometry_key, job.solve));
    if (!kept) return {};
    if (kept->rows() == std::int64_t(scene.patches.size())) return std::move(*kept);
    progress.warning("casts all rays anew: " + job.transport_file().string() + " is of another number of patches");
    return {};
  } catch (const Error& error) {
    progress.warning(std::string("casts all rays anew: ") + error.what());
    return {};
  }
}

}  // namespace

int main(int argc, char** argv) {
  // Large blocks come and go: keep them instead of asking the system for cleared pages again and again.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  return run_stage("solve", argc, argv, [](const Job& job, Progress& progress) {
    const PatchSet scene = read_patches(job.patch_file());
    Transport transport = read_kept(job, scene, progress);
    EnergyField energy = solve(scene, job.solve, transport, progress);
    energy.made = transport.made = provenance(job, progress);
    if (transport.changed && job.solve.method == "matrix") write_transport(job.transport_file(), transport);
    write_energy(job.energy_file(), scene, energy);
  });
}
