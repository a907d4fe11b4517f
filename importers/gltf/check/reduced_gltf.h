#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include <set>

#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// The part of a checked glTF file that the importer reads. Whatever is left out cannot harm a parser.
/// Of texture coordinates the sets stay that are given. Cameras that make no picture keep their place with a
/// vertical extent of zero.
Json reduced_gltf(const Json& root, const std::set<int>& texcoord_sets);

}  // namespace patchlight
