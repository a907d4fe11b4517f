#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include "importers/gltf_json.h"

namespace patchlight {

/// Checks every mesh's TEXCOORD_0: it is looked at only where a shader needs it. Expects accessors that are checked.
/// Throws: Error (bad_data) naming the place.
void check_texcoords(const Json& root, const std::string& file);

}  // namespace patchlight
