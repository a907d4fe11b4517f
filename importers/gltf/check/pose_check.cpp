#include "importers/gltf/check/pose_check.h"

#include <fmt/format.h>

#include <optional>
#include <set>
#include <utility>

#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {
namespace {

using Path = NodeChannel::Path;
using Interpolation = Motion::Interpolation;

std::optional<Path> path_of(const std::string& name) {
  if (name == "translation") return Path::translation;
  if (name == "rotation") return Path::rotation;
  if (name == "scale") return Path::scale;
  if (name == "weights") return Path::weights;
  return std::nullopt;  // path of an extension
}

Interpolation interpolation_of(const Json& sampler, const GltfPlace& place) {
  check_string(sampler, "interpolation", place);
  const std::string name = string_member(sampler, "interpolation");
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  if (!name.empty() && name != "LINEAR") refuse_gltf("interpolation must be LINEAR, STEP or CUBICSPLINE", place);
  return Interpolation::linear;
}

/// Checks an accessor of keyframe times or values. Returns its element count.
std::int64_t checked_count(const GltfLists& gltf, int accessor, const char* shape, bool integers,
                           const GltfPlace& owner) {
  if (accessor < 0) refuse_gltf("has a sampler without input or output", owner);
  const GltfPlace place = gltf.place("accessors", static_cast<std::size_t>(accessor));
  const std::int64_t component = whole_number(*place.item, "componentType", 0, place);
  const bool known = component == 5126 || (integers && component >= 5120 && component <= 5123);
  if (!known || string_member(*place.item, "type") != shape)
    refuse_gltf(fmt::format("must be {} of floats{} for {}", shape, integers ? " or small integers" : "", owner.text()),
                place);
  if (!place.item->contains("bufferView") && !place.item->contains("sparse"))
    refuse_gltf("has keyframes without a bufferView", place);
  return whole_number(*place.item, "count", 0, place);
}

void check_sampler(const GltfLists& gltf, const Json& sampler, NodeChannel& channel, const GltfPlace& place) {
  channel.interpolation = interpolation_of(sampler, place);
  channel.times = index_member(sampler, "input", gltf.count("accessors"), place);
  channel.values = index_member(sampler, "output", gltf.count("accessors"), place);
  const std::int64_t times = checked_count(gltf, channel.times, "SCALAR", false, place);
  const bool rotates = channel.path == Path::rotation, morphs = channel.path == Path::weights;
  const std::int64_t values = checked_count(gltf, channel.values,
                                            rotates  ? "VEC4"
                                            : morphs ? "SCALAR"
                                                     : "VEC3",
                                            rotates || morphs, place);
  const bool spline = channel.interpolation == Interpolation::cubic_spline;
  const std::int64_t each = spline ? 3 : 1;
  if (times == 0) refuse_gltf("has no keyframes", place);
  const bool fits = values / each >= times && values % (times * each) == 0;
  if (!fits || (!morphs && values / each != times))
    refuse_gltf(fmt::format("has {} values for {} keyframes{}", values, times, spline ? " with tangents" : ""), place);
}

/// Marks the nodes that have `member`, and all their ancestors.
std::vector<char> with_ancestors(const Json& nodes, const char* member, const std::vector<int>& parents) {
  std::vector<char> marked(nodes.size(), 0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].contains(member)) continue;
    for (int node = static_cast<int>(i); node >= 0 && !marked[node]; node = parents[node]) marked[node] = 1;
  }
  return marked;
}

}  // namespace

std::vector<NodeChannel> checked_node_channels(const GltfLists& gltf, const std::function<bool(int, Path)>& wanted) {
  std::vector<NodeChannel> result;
  std::set<std::pair<int, Path>> animated;
  gltf.each("animations", [&](const Json& animation, const GltfPlace& place) {
    const Json* channels = find_array(animation, "channels", place);
    const Json* samplers = find_array(animation, "samplers", place);
    if (!channels || !samplers) refuse_gltf("has no channels or no samplers", place);
    for (const Json& channel : *channels) {
      const Json* target = channel.is_object() ? find_object(channel, "target", place) : nullptr;
      if (!target) refuse_gltf("has a channel without a target", place);
      check_string(*target, "path", place);
      const int node = index_member(*target, "node", gltf.count("nodes"), place);
      const std::optional<Path> path = path_of(string_member(*target, "path"));
      if (node < 0 || !path || !wanted(node, *path) || !animated.insert({node, *path}).second) continue;
      if (*path != Path::weights && gltf.list("nodes")[static_cast<std::size_t>(node)].contains("matrix"))
        refuse_gltf(fmt::format("animates nodes[{}], which has a matrix", node), place);
      const int sampler = index_member(channel, "sampler", samplers->size(), place);
      if (sampler < 0 || !(*samplers)[sampler].is_object()) refuse_gltf("has a channel without a sampler", place);
      NodeChannel& found = result.emplace_back();
      found.node = node;
      found.path = *path;
      check_sampler(gltf, (*samplers)[sampler], found, place);
    }
  });
  return result;
}

std::vector<NodeChannel> checked_camera_channels(const GltfLists& gltf, const std::vector<int>& parents,
                                                 std::set<std::string>& ignored) {
  const std::vector<char> camera_or_ancestor = with_ancestors(gltf.list("nodes"), "camera", parents);
  const std::vector<char> mesh_or_ancestor = with_ancestors(gltf.list("nodes"), "mesh", parents);
  std::set<std::pair<int, Path>> seen;
  return checked_node_channels(gltf, [&](int node, Path path) {
    const bool moves_camera = camera_or_ancestor[node] && path != Path::weights;
    if (!moves_camera || mesh_or_ancestor[node])
      ignored.insert(
          "only animations of cameras are imported: everything else stays in its rest pose; set import.time to use "
          "another time");
    if (moves_camera && !seen.insert({node, path}).second)
      ignored.insert("several animations move a camera: the first one is used");
    return moves_camera;
  });
}

}  // namespace patchlight
