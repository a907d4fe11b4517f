#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <vector>

#include "importers/gltf/model/gltf_model.h"

namespace patchlight {

/// Transforms from a node's instances (EXT_mesh_gpu_instancing) to the node; one identity matrix without the extension.
/// Throws: Error (bad_data) naming the node for non-finite numbers.
std::vector<Matrix4> instances_of(const GltfModel& model, int node);

}  // namespace patchlight
