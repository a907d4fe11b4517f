#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "pipeline/model/motion.h"

namespace patchlight {

/// Reads how nodes move.
class MotionReader {
 public:
  explicit MotionReader(const GltfModel& model);

  /// The factors of a camera node's transform to the world, from the node to its root; none if nothing on that way
  /// moves. Throws: Error (bad_data) for keyframes that are not in order or not finite; (over_limit) if so many cameras
  /// share them that they would take too much memory or time.
  std::vector<Motion> motion_of(int camera);

 private:
  Motion read(const NodeChannel& channel);
  void count(std::size_t numbers, int node);
  [[noreturn]] void refuse(const std::string& what, int node) const;
  std::string place(int node) const;

  const GltfModel& model_;
  std::vector<std::array<const NodeChannel*, 4>> channels_;  ///< By node and kind; null: at rest.
  std::size_t read_ = 0;                                     ///< Numbers and nodes so far.
};

/// A node's transform relative to its parent, at rest.
Matrix4 local_matrix(const tinygltf::Node& node);

}  // namespace patchlight
