#pragma once
// Internal to the glTF files of this folder: brings tinygltf along.
#include "importers/gltf/model/gltf_model.h"

namespace patchlight {

/// Unpacks what EXT_meshopt_compression and KHR_draco_mesh_compression pack, and fills in sparse accessors: afterwards
/// bufferViews and accessors are as if the file held plain bytes. Throws: Error (bad_data) for packed bytes that are
/// damaged or hold something else than the file states, and for sparse elements out of range; (over_limit) for too many
/// of these.
void unpack(GltfModel& model);

}  // namespace patchlight
