#include "pipeline/driver/freshness.h"

#include <filesystem>

#include "pipeline/files/energy_file.h"
#include "pipeline/files/frame_list.h"
#include "pipeline/files/image_file.h"
#include "pipeline/files/key.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/files/transport_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& file) {
  std::error_code fault;
  return fs::is_regular_file(file, fault);
}

/// Reads through `read`; what cannot be read is stale for a reason. A fault of the job itself passes through.
template <class Read>
Freshness try_reading(const fs::path& file, Read read) {
  if (std::error_code fault; !fs::exists(file, fault)) return {false, false, file.filename().string() + " is missing"};
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
    if (!is_file(file)) return {false, false, file.string() + " is gone"};
    sources[i].hash = hash_file(file);
    if (sources[i].hash != scene.sources[i].hash) return {false, false, file.filename().string() + " has changed"};
  }
  if (import_inputs_key(sources, job) != scene.inputs_key)
    return {false, false, "settings of `import`, `materials` or `shaders` have changed"};
  return state;
}

Freshness energy_freshness(const Job& job, const PatchSet& scene) {
  EnergyField energy;
  Freshness state = try_reading(job.energy_file(), [&] { energy = read_energy(job.energy_file()); });
  if (!state.fresh) return state;
  if (energy.patches_key != scene.key) return {false, false, "the patches have changed"};
  if (energy.key != energy_key(scene.key, job.solve)) return {false, false, "settings of `solve` have changed"};
  if (job.solve.method != "matrix" || scene.light_groups.empty()) return state;
  std::string transport;
  state = try_reading(job.transport_file(), [&] { transport = read_transport_key(job.transport_file()); });
  if (state.fresh && transport != transport_key(scene.geometry_key, job.solve))
    return {false, false, "transport.h5 belongs to other geometry or settings"};
  return state;
}

Freshness frames_freshness(const Job& job, const PatchSet& scene) {
  const std::string energy = energy_key(scene.key, job.solve), view_config = view_config_key();
  for (const Frame& frame : job_frames(job, scene)) {
    const std::string name = frame.exr.filename().string(), png = frame.png.filename().string();
    Image header;
    Freshness state = try_reading(frame.exr, [&] { header = read_exr_header(frame.exr); });
    if (!state.fresh) return state;
    if (header.metadata["patchlight:key"] != frame_key(scene, energy, job, frame.camera, frame.number, view_config) ||
        header.width != job.trace.resolution[0] || header.height != job.trace.resolution[1])
      return {false, false, name + " was made from something else"};
    if (!is_file(frame.png)) return {false, false, png + " is missing"};
    if (header.metadata["patchlight:png"] != hash_file(frame.png)) return {false, true, png + " is damaged"};
    state = try_reading(frame.exr, [&] { read_exr(frame.exr); });
    if (!state.fresh) return state;
  }
  return {true, false, ""};
}

}  // namespace patchlight
