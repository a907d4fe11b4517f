#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <optional>
#include <vector>

#include "importers/gltf/model/accessor.h"

namespace patchlight {

/// Joint matrices of a skin: from mesh space in the bind pose to world space. `node_to_world` by node.
/// Throws: Error (bad_data) for a non-finite matrix.
std::vector<Matrix4> joint_matrices(const GltfModel& model, int skin, const std::vector<Matrix4>& node_to_world);

/// Deforms the vertices of a mesh primitive by morph targets with constant weights, and by a skin.
class RestPose {
 public:
  /// `weights` of the targets; `joints` as joint_matrices returns them, or empty without a skin.
  /// Throws: Error (bad_data) if accessors have no data or unequal counts.
  RestPose(const GltfModel& model, const tinygltf::Primitive& primitive, const std::vector<double>& weights,
           const std::vector<Matrix4>& joints);

  /// Position and normal of a vertex with the weighted morph targets added, in mesh space; normals not normalised.
  Vec3f morphed_position(std::size_t vertex, const Vec3f& position) const;
  Vec3f morphed_normal(std::size_t vertex, const Vec3f& normal) const;

  bool has_skin() const { return !joint_sets_.empty(); }
  /// Transform of a vertex by the skin. Throws: Error (bad_data) for a joint that does not exist.
  Matrix4 to_world(std::size_t vertex) const;

 private:
  struct Target {
    float weight;
    std::optional<AccessorReader> positions;
    std::optional<AccessorReader> normals;
  };
  /// One JOINTS_n and WEIGHTS_n pair.
  struct JointSet {
    AccessorReader joints;
    AccessorReader weights;
  };

  const std::vector<Matrix4>& joints_;
  std::vector<Target> targets_;
  std::vector<JointSet> joint_sets_;
};

}  // namespace patchlight
