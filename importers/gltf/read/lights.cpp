#include "importers/gltf/read/lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "importers/gltf/read/name_pattern.h"
#include "importers/gltf/read/node_overrides.h"
#include "pipeline/job/light_group_name.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr float kLumensPerWatt = 683.0f;
constexpr double kMaxDistance = 1e12;  // m, as for surfaces

/// The node whose name the user knows: the parent, if Blender's exporter added this node to rotate the light.
int named_node(const GltfModel& model, int node) {
  const int parent = model.checked.parents[node];
  const auto& nodes = model.gltf.nodes;
  return parent >= 0 && nodes[node].name == nodes[parent].name + "_Orientation" ? parent : node;
}

std::string group_of_node(const tinygltf::Node& node) {
  const bool named = node.extras.Has("light_group") && node.extras.Get("light_group").IsString();
  return named ? node.extras.Get("light_group").Get<std::string>() : "";
}

std::string group_of(const GltfModel& model, const Job& job, int node, int named, const GltfLight& source,
                     const std::string& name) {
  std::string group;
  for (const MaterialOverride& change : job.nodes)
    if (change.light_group && matches(change.pattern, name)) group = *change.light_group;
  for (const std::string& other :
       {group_of_node(model.gltf.nodes[node]), group_of_node(model.gltf.nodes[named]), source.light_group, source.name})
    if (group.empty()) group = other;
  return light_group_name(group.empty() ? name : group);
}

/// The first value that the job, the node and the light give, in this order.
std::optional<double> size_of(const std::optional<double>& in_job, const GltfModel& model, int node, int named,
                              const GltfLight& source, std::optional<double> GltfLightExtras::*size) {
  if (in_job) return in_job;
  const auto& extras = model.checked.node_light_extras;
  for (const GltfLightExtras* one : {&extras.at(node), &extras.at(named), &source.extras})
    if (one->*size) return one->*size;
  return std::nullopt;
}

}  // namespace

std::optional<PlacedLight> placed_light(const GltfModel& model, const Job& job, const std::vector<std::string>& names,
                                        int node, const Matrix4& to_world, Progress& progress) {
  const auto found = model.checked.node_lights.find(node);
  if (found == model.checked.node_lights.end()) return std::nullopt;
  const GltfLight& source = model.checked.lights[found->second];
  const int named = named_node(model, node);
  PlacedLight placed{source.light, group_of(model, job, node, named, source, names[named])};
  Light& light = placed.light;
  light.name = names[named];
  if (job.import.punctual_units != "raw") light.strength /= kLumensPerWatt;
  if (light.strength == Color(0.0f) || is_excluded(job.nodes, light.name)) return std::nullopt;
  const auto setting = job.lights.find(placed.group);
  const LightSetting in_job = setting == job.lights.end() ? LightSetting() : setting->second;
  if (light.kind == Light::Kind::sun)
    light.outer = size_of(in_job.angle, model, node, named, source, &GltfLightExtras::angle).value_or(0.0) * kPi / 360;
  else
    light.radius = size_of(in_job.radius, model, node, named, source, &GltfLightExtras::radius).value_or(0.0);
  const Vec3d forward(-to_world[2][0], -to_world[2][1], -to_world[2][2]);
  if (light.kind != Light::Kind::sun) light.position = {to_world[3][0], to_world[3][1], to_world[3][2]};
  for (int k = 0; k < 3; ++k)
    if (!(std::abs(light.position[k]) <= kMaxDistance) || !std::isfinite(forward[k]))
      throw Error(ExitCode::bad_data, "the position or direction of a light is not finite or too far away",
                  fmt::format("{}, nodes[{}] '{}'", model.file.name, node, names[node]),
                  "correct the node's transform");
  if (light.kind == Light::Kind::point) return placed;
  if (!(forward.length() > 0.0)) {
    progress.warning(fmt::format("light '{}' is skipped: its transform has no direction: its local Z axis has length 0",
                                 light.name));
    return std::nullopt;
  }
  light.direction = forward.normalized();
  return placed;
}

void check_light_sizes(const Job& job, const std::vector<Light>& lights, const std::vector<std::string>& groups) {
  for (const auto& [name, setting] : job.lights) {
    const auto check = [&](bool is_set, const char* key, bool is_of_suns) {
      const auto takes = [&](const Light& light) {
        return (light.kind == Light::Kind::sun) == is_of_suns && groups[light.light_group] == name;
      };
      if (!is_set || std::any_of(lights.begin(), lights.end(), takes)) return;
      throw Error(ExitCode::bad_config,
                  fmt::format("the light group `{}` has no {}", name, is_of_suns ? "sun" : "point light or spot"),
                  fmt::format("{}, lights.{}.{}", job.file.string(), name, key),
                  fmt::format("remove the setting; the scene's light groups are: {}", fmt::join(groups, ", ")));
    };
    check(setting.radius.has_value(), "radius", false);
    check(setting.angle.has_value(), "angle", true);
  }
}

}  // namespace patchlight
