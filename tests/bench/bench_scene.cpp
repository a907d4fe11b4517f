#include "tests/bench/bench_scene.h"

#include <cstdlib>

#include "importers/import.h"
#include "tests/bench/generated_scene.h"

namespace patchlight {

Progress& quiet() {
  static Progress progress({"bench", true, ""});
  return progress;
}

const PatchSet& bench_scene() {
  static const PatchSet patches = [] {
    const char* scene = std::getenv("PATCHLIGHT_BENCH_SCENE");
    const std::string name = scene ? scene : PATCHLIGHT_SOURCE "/configs/cornell_box.glb";
    const auto triangles = [&] { return std::stoi(name.substr(name.find(':') + 1)); };
    if (name.starts_with("cave:")) return generated_cave(triangles());
    if (name.starts_with("rings:")) return generated_rings(triangles());
    Job job;
    job.scene = name;
    const char* area = std::getenv("PATCHLIGHT_BENCH_AREA");
    if (area) job.import.patch_area = std::atof(area);
    return import_scene(job, quiet());
  }();
  return patches;
}

}  // namespace patchlight
