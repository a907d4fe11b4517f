#include "pipeline/files/energy_file.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/stage/stage.h"
#include "tracer/trace.h"

int main(int argc, char** argv) {
  using namespace patchlight;
  return run_stage("trace", argc, argv, [](const Job& job, Progress& progress) {
    const PatchSet scene = read_patches(job.patch_file());
    trace_frames(job, scene, read_energy(job.energy_file(), scene), progress);
  });
}
