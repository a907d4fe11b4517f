#include "solver/transport/existing_transport.h"

#include <filesystem>
#include <optional>

#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"

namespace patchlight {

Transport read_existing_transport(const Job& job, const PatchSet& scene, Progress& progress) {
  std::error_code fault;
  if (job.solve.method != "matrix" || !std::filesystem::exists(job.transport_file(), fault)) return {};
  try {
    std::optional<Transport> existing =
        read_transport(job.transport_file(), transport_key(scene.geometry_key, job.solve));
    if (!existing) return {};
    const bool has_mesh_of_scene = !existing->display || fits(existing->display->mesh, scene);
    if (has_mesh_of_scene && existing->rows() == std::int64_t(scene.patches.size())) return std::move(*existing);
    progress.transient_warning("casting all rays again: " + job.transport_file().string() +
                               " has rows for other patches");
    return {};
  } catch (const Error& error) {
    progress.transient_warning(std::string("casting all rays again: ") + error.what());
    return {};
  }
}

}  // namespace patchlight
