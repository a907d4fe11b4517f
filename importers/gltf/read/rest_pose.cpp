#include "importers/gltf/read/rest_pose.h"

#include <fmt/format.h>

#include <cmath>

#include "pipeline/model/error.h"

namespace patchlight {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& place) {
  throw Error(ExitCode::bad_data, what, place, "export the scene again");
}

Vec3f with_morph_targets(Vec3f value, const auto& targets, auto member, std::size_t vertex) {
  for (const auto& target : targets) {
    const std::optional<AccessorReader>& offsets = target.*member;
    if (offsets && offsets->data) value += offsets->vector3(vertex) * target.weight;
  }
  return value;
}

}  // namespace

std::vector<Matrix4> joint_matrices(const GltfModel& model, int skin, const std::vector<Matrix4>& node_to_world) {
  const tinygltf::Skin& source = model.gltf.skins[skin];
  std::optional<AccessorReader> inverse;
  if (source.inverseBindMatrices >= 0) inverse.emplace(model, source.inverseBindMatrices);
  std::vector<Matrix4> result;
  for (std::size_t i = 0; i < source.joints.size(); ++i) {
    Matrix4 matrix = node_to_world[source.joints[i]];
    if (inverse && inverse->data) matrix = Matrix4(inverse->matrix(i)) * matrix;
    for (int k = 0; k < 16; ++k) {
      if (!std::isfinite(matrix.x[k / 4][k % 4])) {
        refuse(fmt::format("the matrix of joint {} is not finite", i),
               fmt::format("{}, skins[{}]", model.file.name, skin));
      }
    }
    result.push_back(matrix);
  }
  return result;
}

RestPose::RestPose(const GltfModel& model, const tinygltf::Primitive& primitive, const std::vector<double>& weights,
                   const std::vector<Matrix4>& joints)
    : joints_(joints) {
  const auto reader = [&](const auto& attributes, const std::string& key) -> std::optional<AccessorReader> {
    const auto found = attributes.find(key);
    if (found == attributes.end()) return std::nullopt;
    return AccessorReader(model, found->second);
  };
  for (std::size_t i = 0; i < std::min(weights.size(), primitive.targets.size()); ++i) {
    if (weights[i] == 0.0) continue;
    targets_.push_back({static_cast<float>(weights[i]), reader(primitive.targets[i], "POSITION"),
                        reader(primitive.targets[i], "NORMAL")});
  }
  for (int set = 0; !joints.empty(); ++set) {
    auto numbers = reader(primitive.attributes, fmt::format("JOINTS_{}", set));
    auto joint_weights = reader(primitive.attributes, fmt::format("WEIGHTS_{}", set));
    if (!numbers || !joint_weights || !numbers->data || !joint_weights->data) break;
    joint_sets_.push_back({std::move(*numbers), std::move(*joint_weights)});
  }
}

Vec3f RestPose::morphed_position(std::size_t vertex, const Vec3f& position) const {
  return with_morph_targets(position, targets_, &Target::positions, vertex);
}

Vec3f RestPose::morphed_normal(std::size_t vertex, const Vec3f& normal) const {
  return with_morph_targets(normal, targets_, &Target::normals, vertex);
}

Matrix4 RestPose::to_world(std::size_t vertex) const {
  Matrix4 sum(0.0);
  double total = 0.0;
  for (const JointSet& set : joint_sets_) {
    const auto numbers = set.joints.vector4(vertex);
    const auto joint_weights = set.weights.vector4(vertex);
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(joint_weights[i] > 0.0f)) continue;
      const auto joint = static_cast<std::size_t>(numbers[i]);
      if (joint >= joints_.size()) {
        refuse(fmt::format("vertex {} refers to joint {}, but the skin has {} joints", vertex, joint, joints_.size()),
               "a skin");
      }
      sum += joints_[joint] * static_cast<double>(joint_weights[i]);
      total += static_cast<double>(joint_weights[i]);
    }
  }
  return total > 0.0 ? sum * (1.0 / total) : Matrix4();
}

}  // namespace patchlight
