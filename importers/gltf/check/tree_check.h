#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <string>
#include <vector>

#include "importers/gltf/check/gltf_json.h"

namespace patchlight {

/// Checks that nodes form trees and that scenes list root nodes without duplicates. `children` by node, all in range.
/// Throws: Error (bad_data) naming the node or scene.
void check_node_trees(const Json& nodes, const Json& scenes, const std::vector<std::vector<int>>& children,
                      const std::string& file);

}  // namespace patchlight
