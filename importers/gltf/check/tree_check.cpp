#include "importers/gltf/check/tree_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace patchlight {
namespace {

using Children = std::vector<std::vector<int>>;

/// Marks the nodes that have a parent.
std::vector<char> nodes_with_parent(const Json& nodes, const Children& children, const std::string& file) {
  std::vector<char> has_parent(children.size(), 0);
  for (const std::vector<int>& list : children) {
    for (const int child : list) {
      if (has_parent[child]) {
        refuse_gltf("has two parents", {file, "nodes", static_cast<std::size_t>(child), &nodes[child]});
      }
      has_parent[child] = 1;
    }
  }
  return has_parent;
}

/// Since every node has at most one parent, nodes that cannot be reached from a root form a cycle.
void refuse_cycles(const Json& nodes, const Children& children, const std::vector<char>& has_parent,
                   const std::string& file) {
  std::vector<char> visited(children.size(), 0);
  std::vector<int> pending;
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (!has_parent[i]) pending.push_back(static_cast<int>(i));
  }
  while (!pending.empty()) {
    const int node = pending.back();
    pending.pop_back();
    visited[node] = 1;
    pending.insert(pending.end(), children[node].begin(), children[node].end());
  }
  const auto unreachable = std::find(visited.begin(), visited.end(), 0);
  if (unreachable == visited.end()) return;
  const auto node = static_cast<std::size_t>(unreachable - visited.begin());
  refuse_gltf("is its own ancestor", {file, "nodes", node, &nodes[node]});
}

void check_scene(const Json& scene, std::size_t nodes, const std::vector<char>& has_parent, const GltfPlace& place) {
  const Json* list = find_array(scene, "nodes", place);
  if (!list) return;
  std::set<int> roots;
  for (const Json& item : *list) {
    const int node = checked_index(item, "nodes", nodes, place);
    if (has_parent[node]) refuse_gltf(fmt::format("nodes[{}] is not a root node", node), place, "nodes");
    if (!roots.insert(node).second) refuse_gltf(fmt::format("nodes[{}] is listed twice", node), place, "nodes");
  }
}

}  // namespace

void check_node_trees(const Json& nodes, const Json& scenes, const std::vector<std::vector<int>>& children,
                      const std::string& file) {
  const std::vector<char> has_parent = nodes_with_parent(nodes, children, file);
  refuse_cycles(nodes, children, has_parent, file);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    check_scene(scenes[i], nodes.size(), has_parent, {file, "scenes", i, &scenes[i]});
  }
}

}  // namespace patchlight
