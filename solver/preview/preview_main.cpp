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
  return run_stage(
      "preview", argc, argv, body,
      {{.name = "--picture",
        .value = &picture,
        .help = "The PNG to draw",
        .required = true,
        .completion = Option::Completion::file},
       {.name = "--kind",
        .value = &preview.kind,
        .help = "What to draw",
        .choices = {"patches", "radiosity", "irradiance", "hemicube"}},
       {.name = "--camera", .value = &preview.camera, .help = "From which camera; absent: the job's first"},
       {.name = "--patch", .value = &preview.patch, .help = "The patch to highlight, or whose hemicube to draw"}});
}
