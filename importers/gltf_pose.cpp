#include "importers/gltf_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "importers/gltf_accessor.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

using Path = NodeChannel::Path;
using Interpolation = Motion::Interpolation;
using Numbers = std::vector<double>;

/// Keyframes of one channel.
struct Keyframes {
  Keyframes(const GltfModel& model, const NodeChannel& source)
      : channel(source), times(model, source.times), values(model, source.values) {
    if (!times.data || !values.data) {
      throw Error(ExitCode::bad_data, "keyframes have no data",
                  fmt::format("{}, nodes[{}]", model.file.name, source.node), "export the scene again");
    }
    splines = source.interpolation == Interpolation::cubic_spline;
    components = source.path == Path::weights ? 1 : source.path == Path::rotation ? 4 : 3;
    elements = values.count / (times.count * (splines ? 3 : 1));
  }

  const NodeChannel& channel;
  AccessorReader times;
  AccessorReader values;
  bool splines = false;
  std::size_t components = 0;  ///< Of an element.
  std::size_t elements = 0;    ///< Of a value.

  double time(std::size_t key) const { return static_cast<double>(times.component(key, 0)); }

  /// Of a spline, `part` 0 is the tangent before, 1 the value, 2 the tangent behind.
  Numbers value(std::size_t key, std::size_t part = 1) const {
    const std::size_t first = (splines ? 3 * key + part : key) * elements;
    Numbers result;
    for (std::size_t i = 0; i < elements * components; ++i)
      result.push_back(static_cast<double>(values.component(first + i / components, i % components)));
    return result;
  }

  Numbers at(double moment) const;
};

Numbers mixed(const Numbers& a, double of_a, const Numbers& b, double of_b) {
  Numbers result;
  for (std::size_t i = 0; i < a.size(); ++i) result.push_back(a[i] * of_a + b[i] * of_b);
  return result;
}

double dot(const Numbers& a, const Numbers& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Spherical interpolation of unit quaternions, the shorter way.
Numbers turned(const Numbers& a, const Numbers& b, double t) {
  const double cosine = dot(a, b);
  const double sign = cosine < 0.0 ? -1.0 : 1.0;
  const double angle = std::acos(std::min(std::abs(cosine), 1.0));
  if (!(angle > 1e-6)) return mixed(a, 1.0 - t, b, sign * t);
  return mixed(a, std::sin((1.0 - t) * angle) / std::sin(angle), b, sign * std::sin(t * angle) / std::sin(angle));
}

Numbers Keyframes::at(double moment) const {
  std::size_t low = 0, high = times.count;  // the first keyframe after the moment
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    (time(middle) <= moment ? low : high) = time(middle) <= moment ? middle + 1 : middle;
  }
  if (low == 0) return value(0);
  const std::size_t key = low - 1;
  if (low == times.count || channel.interpolation == Interpolation::step) return value(key);
  const double length = time(low) - time(key);
  const double t = (moment - time(key)) / length;
  if (!splines) {
    return channel.path == Path::rotation ? turned(value(key), value(low), t)
                                          : mixed(value(key), 1.0 - t, value(low), t);
  }
  const double t2 = t * t, t3 = t2 * t;
  const Numbers places = mixed(value(key), 2 * t3 - 3 * t2 + 1, value(low), 3 * t2 - 2 * t3);
  const Numbers tangents = mixed(value(key, 2), length * (t3 - 2 * t2 + t), value(low, 0), length * (t3 - t2));
  return mixed(places, 1.0, tangents, 1.0);
}

}  // namespace

void pose_nodes(GltfModel& model, double time) {
  for (const NodeChannel& channel : model.checked.node_channels) {
    const Numbers value = Keyframes(model, channel).at(time);
    if (!std::all_of(value.begin(), value.end(), [](double x) { return std::isfinite(x); })) {
      throw Error(ExitCode::bad_data, "a keyframe that is not finite",
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
