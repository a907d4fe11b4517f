#include <CLI/CLI.hpp>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/stage/stage.h"
#include "solver/preview/preview.h"

// A separate program, so that solving does not load the libraries for images.
int main(int argc, char** argv) {
  using namespace patchlight;
  PreviewOptions preview;
  std::string picture;
  const auto body = [&](const Job& job, Progress& progress) {
    write_png(picture, draw_preview(job, read_patches(job.patch_file()), preview));
    progress.note(picture);
  };
  return run_stage("preview", argc, argv, body, [&](CLI::App& app) {
    app.add_option("--picture", picture, "The PNG to draw")->required();
    app.add_option("--kind", preview.kind)->check(CLI::IsMember({"patches", "radiosity", "irradiance", "hemicube"}));
    app.add_option("--camera", preview.camera);
    app.add_option("--patch", preview.patch);
  });
}
