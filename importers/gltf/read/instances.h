#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <vector>

#include "importers/gltf/model/gltf_model.h"

namespace patchlight {

/// Transforms of a node's instances (EXT_mesh_gpu_instancing) to the node; one that changes nothing for a node without.
/// Throws: Error (bad_data) naming the node for numbers that are not finite.
std::vector<Matrix4> instances_of(const GltfModel& model, int node);

}  // namespace patchlight
