#include <string>

#include "importers/import.h"
#include "pipeline/formats/describe.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/job/reader/scene_file.h"
#include "pipeline/stage/stage.h"
#include "pipeline/system/standard_streams.h"

int main(int argc, char** argv) {
  using namespace patchlight;
  if (argc == 3 && std::string(argv[1]) == "--info") {  // for `patchlight info`
    return with_progress("import", {}, [&](Progress& progress) {
      Job job;
      job.scene = argv[2];
      if (is_blender_file(job.scene)) job = read_job(job.scene);
      print(describe(import_scene(job, progress)));
    });
  }
  return run_stage("import", argc, argv, [](const Job& job, Progress& progress) {
    PatchSet scene = import_scene(job, progress);
    scene.made = provenance(job, progress);
    write_patches(job.patch_file(), scene);
  });
}
