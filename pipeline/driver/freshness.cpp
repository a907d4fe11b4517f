#include "pipeline/driver/freshness.h"

#include <filesystem>

#include "pipeline/files/energy_file.h"
#include "pipeline/files/frame_list.h"
#include "pipeline/files/image_file.h"
#include "pipeline/files/key.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// Reads through `read`; what cannot be read is stale for a reason. A fault of the job itself passes through.
template <class Read>
Freshness try_reading(const fs::path& file, Read read) {
  if (!fs::exists(file)) return {false, false, file.filename().string() + " is missing"};
  try {
    read();
    return {true, false, ""};
  } catch (const Error& error) {
    if (error.code() != ExitCode::bad_data) throw;
    return {false, true, error.what()};
  }
}

}  // namespace

Freshness patches_freshness(const Job& job, PatchSet& scene) {
  Freshness state = try_reading(job.patch_file(), [&] { scene = read_patches(job.patch_file()); });
  if (!state.fresh) return state;
  std::vector<SourceFile> sources = scene.sources;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const fs::path file = i == 0 ? job.scene : job.scene.parent_path() / sources[i].path;
    if (!fs::exists(file)) return {false, false, file.string() + " is gone"};
    sources[i].hash = hash_file(file);
    if (sources[i].hash != scene.sources[i].hash) return {false, false, file.filename().string() + " has changed"};
  }
  if (import_inputs_key(sources, job) != scene.inputs_key)
    return {false, false, "settings of `import`, `materials` or `shaders` have changed"};
  return state;
}

Freshness energy_freshness(const Job& job, const PatchSet& scene, std::string& key) {
  EnergyField energy;
  Freshness state = try_reading(job.energy_file(), [&] {
    energy.patches_key = energy_patches_key(job.energy_file());
    if (energy.patches_key == scene.key) energy = read_energy(job.energy_file(), scene);
  });
  if (!state.fresh) return state;
  if (energy.patches_key != scene.key) return {false, false, "the patches have changed"};
  if (energy.key != energy_key(scene.key, job.solve)) return {false, false, "settings of `solve` have changed"};
  key = energy.key;
  return state;
}

Freshness frames_freshness(const Job& job, const PatchSet& scene, const std::string& energy_key) {
  for (const Frame& frame : job_frames(job, scene)) {
    std::string key;
    Freshness state = try_reading(frame.exr, [&] { key = read_exr(frame.exr).metadata["patchlight:key"]; });
    if (!state.fresh) return state;
    if (!fs::exists(frame.png)) return {false, false, frame.png.filename().string() + " is missing"};
    if (key != frame_key(scene, energy_key, job, scene.cameras[frame.camera].name, frame.number))
      return {false, false, frame.exr.filename().string() + " was made from something else"};
  }
  return {true, false, ""};
}

}  // namespace patchlight
