#pragma once
#include "importers/gltf/read/gltf_reader.h"
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Whether the job leaves out what has this name; the last pattern that says so or not counts.
bool is_excluded(const std::vector<MaterialOverride>& overrides, const std::string& name);

/// Takes the surfaces out of the scene whose material or node the job excludes.
void leave_out_excluded(const GltfModel& model, const Job& job, GltfScene& scene);

/// Gives surfaces on nodes that the job overrides materials of their own.
/// Throws: Error (bad_data, bad_config) for values out of range.
void override_nodes(const GltfModel& model, const Job& job, GltfScene& scene, Progress& progress);

}  // namespace patchlight
