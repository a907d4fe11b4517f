#pragma once
#include <vector>

namespace patchlight {

struct GltfLists;
struct GltfModel;

/// What an animation moves of one node.
struct NodeChannel {
  enum class Path { translation, rotation, scale, weights };
  enum class Interpolation { step, linear, cubic_spline };

  int node = 0;
  Path path = Path::translation;
  Interpolation interpolation = Interpolation::linear;
  int times = 0, values = 0;  ///< Accessors.
};

/// The channels of all animations, each property of a node once, the first that moves it; checked as to types and
/// counts. Throws: Error (bad_data) naming the animation.
std::vector<NodeChannel> checked_node_channels(const GltfLists& gltf);

/// Moves nodes, and sets the weights of morph targets, to where animations have them at `time`, s; before their first
/// and after their last keyframe as there. Throws: Error (bad_data) if keyframes have no data.
void pose_nodes(GltfModel& model, double time);

}  // namespace patchlight
