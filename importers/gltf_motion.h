#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "importers/gltf_model.h"
#include "pipeline/model/motion.h"

namespace patchlight {

/// Reads how nodes move.
class MotionReader {
 public:
  explicit MotionReader(const GltfModel& model);

  /// The factors of a node's transform to the world, from the node to its root; none if nothing on that way moves.
  /// Throws: Error (bad_data) for keyframes that are not in order or not finite; (over_limit) if so many cameras share
  /// them that they would take too much memory.
  std::vector<Motion> motion_of(int node);

 private:
  Motion read(const GltfChannel& channel);

  const GltfModel& model_;
  std::vector<int> parents_;                                 ///< By node; -1: a root.
  std::vector<std::array<const GltfChannel*, 4>> channels_;  ///< By node and kind; null: at rest.
  std::size_t read_ = 0;                                     ///< Numbers so far.
};

/// A node's transform relative to its parent, at rest.
Matrix4 local_matrix(const tinygltf::Node& node);

}  // namespace patchlight
