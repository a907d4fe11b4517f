#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "pipeline/model/motion.h"

namespace patchlight {

/// Reads the motion of cameras.
class MotionReader {
 public:
  explicit MotionReader(const GltfModel& model);

  /// The factors of a camera node's transform to the world, from the node to its root; empty if no node on this path is
  /// animated. Throws: Error (bad_data) for unsorted or non-finite keyframes; (over_limit) if all cameras together have
  /// too many.
  std::vector<Motion> motion_of(int camera);

 private:
  Motion read(const NodeChannel& channel);
  void count(std::size_t numbers, int node);
  [[noreturn]] void refuse(const std::string& what, int node) const;
  std::string place(int node) const;

  const GltfModel& model_;
  std::vector<std::array<const NodeChannel*, 4>> channels_;  ///< By node and kind; null: not animated.
  std::size_t read_ = 0;                                     ///< Keyframe numbers and nodes read so far.
};

/// A node's rest transform relative to its parent.
Matrix4 local_matrix(const tinygltf::Node& node);

}  // namespace patchlight
