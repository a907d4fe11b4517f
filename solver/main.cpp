#include "pipeline/files/energy_file.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/stage/stage.h"
#include "solver/solve.h"

int main(int argc, char** argv) {
  using namespace patchlight;
  return run_stage("solve", argc, argv, [](const Job& job, Progress& progress) {
    const PatchSet scene = read_patches(job.patch_file());
    write_energy(job.energy_file(), scene, solve(scene, job.solve, progress));
  });
}
