#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include "importers/gltf_json.h"

namespace patchlight {

/// The part of a checked glTF file that the importer reads. Whatever is left out cannot harm a parser.
/// Texture coordinates stay only if `texcoords` asks for them. Cameras that make no picture keep their place with a
/// vertical extent of zero.
Json reduced_gltf(const Json& root, bool texcoords);

}  // namespace patchlight
