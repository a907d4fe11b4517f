#include "importers/gltf_animation_check.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace patchlight {
namespace {

/// Marks the nodes that have `member` and all nodes above them.
std::vector<char> at_or_above(const Json& nodes, const char* member, const std::vector<int>& parents) {
  std::vector<char> marked(nodes.size(), 0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].contains(member)) continue;
    for (int node = static_cast<int>(i); node >= 0 && !marked[node]; node = parents[node]) marked[node] = 1;
  }
  return marked;
}

std::optional<Motion::Kind> kind_of(const std::string& path) {
  if (path == "translation") return Motion::Kind::translation;
  if (path == "rotation") return Motion::Kind::rotation;
  if (path == "scale") return Motion::Kind::scale;
  return std::nullopt;
}

Motion::Interpolation interpolation_of(const Json& sampler, const GltfPlace& place) {
  check_string(sampler, "interpolation", place);
  const std::string name = string_member(sampler, "interpolation");
  if (name == "STEP") return Motion::Interpolation::step;
  if (name == "CUBICSPLINE") return Motion::Interpolation::cubic_spline;
  if (!name.empty() && name != "LINEAR") refuse_gltf("interpolation must be LINEAR, STEP or CUBICSPLINE", place);
  return Motion::Interpolation::linear;
}

/// Number of an accessor's elements. Refuses one of another type; `small`: it may hold normalized integers.
std::int64_t checked_count(const Json& accessors, int index, const std::string& type, bool small,
                           const GltfPlace& place) {
  if (index < 0) refuse_gltf("has a sampler without input or output", place);
  const Json& accessor = accessors[static_cast<std::size_t>(index)];
  const GltfPlace source{place.file, "accessors", static_cast<std::size_t>(index), &accessor};
  if (accessor.contains("sparse")) refuse_gltf("sparse accessors are not supported for animations", source);
  const std::int64_t component = whole_number(accessor, "componentType", 0, source);
  const bool integer = component >= 5120 && component <= 5123;
  if (string_member(accessor, "type") != type || (component != 5126 && !(small && integer)))
    refuse_gltf(
        fmt::format("must be {} of {} for {}", type, small ? "floats or small integers" : "floats", place.text()),
        source);
  if (!accessor.contains("bufferView")) refuse_gltf("keyframes have no bufferView", source);
  return whole_number(accessor, "count", 0, source);
}

GltfChannel checked_channel(const Json& sampler, Motion::Kind kind, const Json& accessors, const GltfPlace& place) {
  const bool rotation = kind == Motion::Kind::rotation;
  GltfChannel channel;
  channel.kind = kind;
  channel.interpolation = interpolation_of(sampler, place);
  channel.times = index_member(sampler, "input", accessors.size(), place);
  channel.values = index_member(sampler, "output", accessors.size(), place);
  const std::int64_t times = checked_count(accessors, channel.times, "SCALAR", false, place);
  const std::int64_t values = checked_count(accessors, channel.values, rotation ? "VEC4" : "VEC3", rotation, place);
  if (times == 0) refuse_gltf("has no keyframes", place);
  const bool spline = channel.interpolation == Motion::Interpolation::cubic_spline;
  if (values % (spline ? 3 : 1) != 0 || values / (spline ? 3 : 1) != times)
    refuse_gltf(fmt::format("has {} values for {} keyframes{}", values, times, spline ? " with tangents" : ""), place);
  return channel;
}

}  // namespace

std::vector<GltfChannel> camera_channels(const Json& root, const std::vector<int>& parents, const std::string& file,
                                         std::set<std::string>& ignored) {
  const Json& nodes = object_list(root, "nodes", file);
  const Json& animations = object_list(root, "animations", file);
  const Json& accessors = object_list(root, "accessors", file);
  const std::vector<char> above_camera = at_or_above(nodes, "camera", parents);
  const std::vector<char> above_mesh = at_or_above(nodes, "mesh", parents);
  std::vector<GltfChannel> result;
  std::set<std::pair<int, Motion::Kind>> taken;
  for (std::size_t i = 0; i < animations.size(); ++i) {
    const GltfPlace place{file, "animations", i, &animations[i]};
    const Json* channels = find_array(animations[i], "channels", place);
    const Json* samplers = find_array(animations[i], "samplers", place);
    if (!channels || !samplers) refuse_gltf("has no channels or no samplers", place);
    for (const Json& channel : *channels) {
      const Json* target = channel.is_object() ? find_object(channel, "target", place) : nullptr;
      if (!target) refuse_gltf("has a channel without a target", place);
      check_string(*target, "path", place);
      const int node = index_member(*target, "node", nodes.size(), place);
      if (node < 0) continue;  // of an extension
      const std::optional<Motion::Kind> kind = kind_of(string_member(*target, "path"));
      const bool moves_camera = above_camera[node] && kind;
      if (!moves_camera || above_mesh[node])
        ignored.insert("animations are read for cameras alone: all else stands in its rest state");
      if (!moves_camera) continue;
      if (nodes[static_cast<std::size_t>(node)].contains("matrix"))
        refuse_gltf(fmt::format("moves nodes[{}], which has a matrix", node), place);
      const int sampler = index_member(channel, "sampler", samplers->size(), place);
      if (sampler < 0 || !(*samplers)[sampler].is_object()) refuse_gltf("has a channel without a sampler", place);
      if (!taken.insert({node, *kind}).second) {
        ignored.insert("several animations move a camera: the first of them counts");
        continue;
      }
      result.push_back(checked_channel((*samplers)[sampler], *kind, accessors, place));
      result.back().node = node;
    }
  }
  return result;
}

}  // namespace patchlight
