#include "importers/gltf/read/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "importers/gltf/model/accessor.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::size_t kMaxNumbers = 10'000'000;

std::vector<double> numbers(const GltfModel& model, int accessor, int width) {
  const AccessorReader reader(model, accessor);
  std::vector<double> result;
  if (!reader.data) return result;
  result.reserve(reader.count * static_cast<std::size_t>(width));
  for (std::size_t i = 0; i < reader.count; ++i)
    for (int k = 0; k < width; ++k) result.push_back(reader.component(i, static_cast<std::size_t>(k)));
  return result;
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

Motion constant(const Matrix4& matrix) {
  Motion factor;
  factor.values.assign(&matrix[0][0], &matrix[0][0] + 16);
  return factor;
}

/// The scale, rotation or translation of a node's rest transform. glTF's column-major matrices for column vectors equal
/// Imath's row-major matrices for row vectors.
Matrix4 rest_factor(const tinygltf::Node& node, Motion::Kind kind) {
  Matrix4 matrix;
  if (kind == Motion::Kind::scale && node.scale.size() == 3)
    matrix.setScale(Vec3d(node.scale[0], node.scale[1], node.scale[2]));
  if (kind == Motion::Kind::rotation && node.rotation.size() == 4)
    matrix = rotation_matrix({node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]});
  if (kind == Motion::Kind::translation && node.translation.size() == 3)
    matrix.setTranslation(Vec3d(node.translation[0], node.translation[1], node.translation[2]));
  return matrix;
}

Motion::Kind kind_of(NodeChannel::Path path) {
  return path == NodeChannel::Path::translation ? Motion::Kind::translation
         : path == NodeChannel::Path::rotation  ? Motion::Kind::rotation
                                                : Motion::Kind::scale;
}

constexpr std::array kOrder{Motion::Kind::scale, Motion::Kind::rotation, Motion::Kind::translation};

}  // namespace

Matrix4 local_matrix(const tinygltf::Node& node) {
  Matrix4 matrix;
  if (node.matrix.size() == 16) {
    std::copy(node.matrix.begin(), node.matrix.end(), &matrix[0][0]);
    return matrix;
  }
  for (const Motion::Kind kind : kOrder) matrix *= rest_factor(node, kind);
  return matrix;
}

MotionReader::MotionReader(const GltfModel& model) : model_(model), channels_(model.gltf.nodes.size()) {
  for (const NodeChannel& channel : model.checked.camera_channels)
    channels_[channel.node][static_cast<std::size_t>(kind_of(channel.path))] = &channel;
}

std::vector<Motion> MotionReader::motion_of(int camera) {
  std::vector<Motion> factors;
  if (model_.checked.camera_channels.empty()) return factors;
  Matrix4 static_product;  // of the constant factors since the last animated one
  const auto append_static = [&] {
    if (static_product == Matrix4()) return;
    factors.push_back(constant(static_product));
    if (!all_finite(factors.back().values)) refuse("a transform is not finite", camera);
    static_product = Matrix4();
  };
  bool animated = false;
  for (int node = camera; node >= 0; node = model_.checked.parents[node]) {
    count(1, node);
    if (channels_[node] == std::array<const NodeChannel*, 4>{}) {
      static_product *= local_matrix(model_.gltf.nodes[node]);
      continue;
    }
    for (const Motion::Kind kind : kOrder) {
      const NodeChannel* channel = channels_[node][static_cast<std::size_t>(kind)];
      if (!channel) {
        static_product *= rest_factor(model_.gltf.nodes[node], kind);
        continue;
      }
      append_static();
      factors.push_back(read(*channel));
      animated = true;
    }
  }
  append_static();
  return animated ? factors : std::vector<Motion>();
}

Motion MotionReader::read(const NodeChannel& channel) {
  Motion motion;
  motion.kind = kind_of(channel.path);
  motion.interpolation = channel.interpolation;
  count(model_.gltf.accessors[channel.times].count * static_cast<std::size_t>(1 + motion.stride()), channel.node);
  motion.times = numbers(model_, channel.times, 1);
  motion.values = numbers(model_, channel.values, motion.width());
  if (motion.times.empty() || motion.values.empty()) refuse("keyframes have no data", channel.node);
  if (!all_finite(motion.times) || !all_finite(motion.values)) refuse("a keyframe is not finite", channel.node);
  if (!std::is_sorted(motion.times.begin(), motion.times.end()))
    refuse("keyframe times are not ascending", channel.node);
  return motion;
}

void MotionReader::count(std::size_t numbers, int node) {
  read_ += numbers;
  if (read_ > kMaxNumbers)
    throw Error(ExitCode::over_limit, fmt::format("keyframes of cameras have more than {} numbers", kMaxNumbers),
                place(node), "export fewer animated cameras, or fewer keyframes");
}

void MotionReader::refuse(const std::string& what, int node) const {
  throw Error(ExitCode::bad_data, what, place(node), "export the scene again, or without animations");
}

std::string MotionReader::place(int node) const {
  return fmt::format("{}, animation of nodes[{}] '{}'", model_.file.name, node, model_.gltf.nodes[node].name);
}

}  // namespace patchlight
