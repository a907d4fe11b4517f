#pragma once
// Internal to importers/gltf: includes tinygltf.
#include "importers/gltf/model/gltf_model.h"

namespace patchlight {

/// Decodes EXT_meshopt_compression, KHR_meshopt_compression and KHR_draco_mesh_compression and expands sparse
/// accessors: afterwards all bufferViews and accessors are plain. Throws: Error (bad_data) for damaged bytes, counts or
/// types that differ from the accessors', and sparse indices out of range; (over_limit) if sparse accessors take too
/// much memory.
void decompress(GltfModel& model);

}  // namespace patchlight
