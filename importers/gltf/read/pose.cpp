#include "importers/gltf/read/pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "importers/gltf/model/accessor.h"
#include "pipeline/model/error.h"
#include "pipeline/model/keyframes.h"

namespace patchlight {
namespace {

using Path = NodeChannel::Path;

/// The value of a channel at a time in s. Reads only the neighbouring keyframes.
std::vector<double> value_of(const GltfModel& model, const NodeChannel& channel, double seconds) {
  const AccessorReader times(model, channel.times), values(model, channel.values);
  if (!times.data || !values.data) {
    throw Error(ExitCode::bad_data, "keyframes have no data",
                fmt::format("{}, nodes[{}]", model.file.name, channel.node), "export the scene again");
  }
  const bool spline = channel.interpolation == Motion::Interpolation::cubic_spline;
  const std::size_t components = channel.path == Path::weights ? 1 : channel.path == Path::rotation ? 4 : 3;
  const std::size_t elements = values.count / (times.count * (spline ? 3 : 1));
  const auto value = [&](std::size_t key, int part) {
    const std::size_t first = (spline ? 3 * key + static_cast<std::size_t>(part) : key) * elements;
    std::vector<double> result;
    for (std::size_t i = 0; i < elements * components; ++i)
      result.push_back(static_cast<double>(values.component(first + i / components, i % components)));
    return result;
  };
  return value_at({times.count, channel.interpolation, channel.path == Path::rotation,
                   [&](std::size_t key) { return static_cast<double>(times.component(key, 0)); }, value},
                  seconds);
}

}  // namespace

void pose_nodes(GltfModel& model, double time) {
  for (const NodeChannel& channel : model.checked.node_channels) {
    const std::vector<double> value = value_of(model, channel, time);
    if (!std::all_of(value.begin(), value.end(), [](double x) { return std::isfinite(x); })) {
      throw Error(ExitCode::bad_data, "a keyframe is not finite",
                  fmt::format("{}, nodes[{}]", model.file.name, channel.node), "export the scene again");
    }
    tinygltf::Node& node = model.gltf.nodes[channel.node];
    (channel.path == Path::translation ? node.translation
     : channel.path == Path::rotation  ? node.rotation
     : channel.path == Path::scale     ? node.scale
                                       : node.weights) = value;
  }
}

}  // namespace patchlight
