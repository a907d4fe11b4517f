#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include <string>
#include <vector>

#include "importers/gltf/check/gltf_json.h"

namespace patchlight {

/// Checks that every node has one parent at most and is not its own ancestor, and that scenes hold root nodes, each
/// once. `children` by node, all in range. Throws: Error (bad_data) naming the node or scene.
void check_node_trees(const Json& nodes, const Json& scenes, const std::vector<std::vector<int>>& children,
                      const std::string& file);

}  // namespace patchlight
