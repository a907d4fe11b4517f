#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <set>

#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// The part of a checked glTF file that the importer reads; anything else could trigger faults of the parser. Of
/// texture coordinates, only these sets are kept. Invalid cameras get a vertical extent of 0, so that indices stay
/// valid.
Json reduced_gltf(const Json& root, const std::set<int>& texcoord_sets);

}  // namespace patchlight
