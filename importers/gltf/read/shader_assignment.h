#pragma once
#include "importers/gltf/read/gltf_reader.h"
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// By shader of the job: whether it uses u or v.
/// Throws: Error (bad_config) with the position of the fault in the first expression that does not compile.
std::vector<char> check_shaders(const Job& job);

/// Assigns to each surface the last of the job's shaders whose name matches its material or its node. The shaders in
/// use are added to `scene`. `uses_uv` as check_shaders returns it.
void assign_shaders(const Job& job, const std::vector<char>& uses_uv, GltfScene& scene, Progress& progress);

}  // namespace patchlight
