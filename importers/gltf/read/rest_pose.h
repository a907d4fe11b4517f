#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <optional>
#include <vector>

#include "importers/gltf/model/accessor.h"

namespace patchlight {

/// A skin's joints as they stand: where each takes a vertex of the mesh that is bound to it, in the world.
/// `node_to_world` by node. Throws: Error (bad_data) for a matrix that is not finite.
std::vector<Matrix4> joint_matrices(const GltfModel& model, int skin, const std::vector<Matrix4>& node_to_world);

/// Bends the vertices of a mesh primitive: by its morph targets with the weights that the file starts from, and by a
/// skin.
class RestPose {
 public:
  /// `weights` of the targets; `joints` as joint_matrices returns them, or empty without a skin.
  /// Throws: Error (bad_data) if accessors have no data or unequal counts.
  RestPose(const GltfModel& model, const tinygltf::Primitive& primitive, const std::vector<double>& weights,
           const std::vector<Matrix4>& joints);

  /// Adds the targets' parts to a position or normal of the mesh.
  Vec3f morphed_position(std::size_t vertex, const Vec3f& position) const;
  Vec3f morphed_normal(std::size_t vertex, const Vec3f& normal) const;

  bool has_skin() const { return !bones_.empty(); }
  /// Where the skin takes a vertex. Throws: Error (bad_data) for a joint that does not exist.
  Matrix4 to_world(std::size_t vertex) const;

 private:
  struct Target {
    float weight;
    std::optional<AccessorReader> positions;
    std::optional<AccessorReader> normals;
  };
  struct Bones {
    AccessorReader joints;
    AccessorReader weights;
  };

  const std::vector<Matrix4>& joints_;
  std::vector<Target> targets_;
  std::vector<Bones> bones_;  ///< Of four joints each.
};

}  // namespace patchlight
