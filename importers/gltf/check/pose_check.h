#pragma once
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/model/motion.h"

namespace patchlight {

struct GltfLists;

/// What an animation moves of one node.
struct NodeChannel {
  enum class Path { translation, rotation, scale, weights };

  int node = 0;
  Path path = Path::translation;
  Motion::Interpolation interpolation = Motion::Interpolation::linear;
  int times = 0, values = 0;  ///< Accessors.
};

/// The channels of all animations that are `wanted`, each property of a node once, the first that moves it; checked as
/// to types and counts. Throws: Error (bad_data) naming the animation.
std::vector<NodeChannel> checked_node_channels(const GltfLists& gltf,
                                               const std::function<bool(int node, NodeChannel::Path)>& wanted);

/// Those that move cameras: of camera nodes, and of nodes above them by `parents`, -1 for a root. What else is animated
/// goes to `ignored`, as one warning.
std::vector<NodeChannel> checked_camera_channels(const GltfLists& gltf, const std::vector<int>& parents,
                                                 std::set<std::string>& ignored);

}  // namespace patchlight
