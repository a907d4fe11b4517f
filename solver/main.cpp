#include <CLI/CLI.hpp>

#include "pipeline/files/energy_file.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/stage/stage.h"
#include "solver/preview.h"
#include "solver/solve.h"

int main(int argc, char** argv) {
  using namespace patchlight;
  PreviewOptions preview;
  std::string picture;
  const auto body = [&](const Job& job, Progress& progress) {
    const PatchSet scene = read_patches(job.patch_file());
    if (picture.empty()) {
      write_energy(job.energy_file(), scene, solve(scene, job.solve, progress));
    } else {
      write_preview(picture, job, scene, preview);
      progress.note(picture);
    }
  };
  return run_stage("solve", argc, argv, body, [&](CLI::App& app) {
    app.add_option("--preview", picture, "Draw a preview into this PNG instead of solving (see `patchlight preview`)");
    app.add_option("--kind", preview.kind);
    app.add_option("--camera", preview.camera);
    app.add_option("--patch", preview.patch);
  });
}
