#pragma once
#include "importers/gltf/read/gltf_reader.h"
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Whether the job excludes a material or node of this name; the last matching pattern with `exclude` decides.
bool is_excluded(const std::vector<MaterialOverride>& overrides, const std::string& name);

/// Removes the surfaces whose material or node the job excludes.
void remove_excluded(const GltfModel& model, const Job& job, GltfScene& scene);

/// Gives surfaces on nodes with overrides their own materials.
/// Throws: Error (bad_data, bad_config) for values out of range.
void override_nodes(const GltfModel& model, const Job& job, GltfScene& scene, Progress& progress);

}  // namespace patchlight
