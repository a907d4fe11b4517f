#pragma once
#include "importers/gltf/read/gltf_reader.h"
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// For each of the job's shaders, whether it reads u or v.
/// Throws: Error (bad_config) that points into the first expression that does not compile.
std::vector<char> check_shaders(const Job& job);

/// Gives each surface the last of the job's shaders whose name matches its material or its node, and `scene` those in
/// use. `reads_uv` as check_shaders returns it.
void assign_shaders(const Job& job, const std::vector<char>& reads_uv, GltfScene& scene, Progress& progress);

}  // namespace patchlight
