#pragma once
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/model/motion.h"

namespace patchlight {

struct GltfLists;

/// An animation channel: one animated property of a node.
struct NodeChannel {
  enum class Path { translation, rotation, scale, weights };

  int node = 0;
  Path path = Path::translation;
  Motion::Interpolation interpolation = Motion::Interpolation::linear;
  int times = 0, values = 0;  ///< Accessors of the keyframes.
};

/// Checks and returns the channels of all animations for which `wanted` is true; for each property of a node only the
/// first one. Throws: Error (bad_data) naming the animation.
std::vector<NodeChannel> checked_node_channels(const GltfLists& gltf,
                                               const std::function<bool(int node, NodeChannel::Path)>& wanted);

/// The channels that move cameras: of camera nodes and their ancestors. `parents`: by node, -1 for a root. Adds
/// warnings of other channels to `ignored`.
std::vector<NodeChannel> checked_camera_channels(const GltfLists& gltf, const std::vector<int>& parents,
                                                 std::set<std::string>& ignored);

}  // namespace patchlight
