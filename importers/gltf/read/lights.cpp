#include "importers/gltf/read/lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "importers/gltf/read/name_pattern.h"
#include "importers/gltf/read/node_overrides.h"
#include "pipeline/job/light_group_name.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr float kLumensPerWatt = 683.0f;
constexpr double kMaxStrength = 3e38;
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

/// A node's light of KHR_lights_punctual, or else a point light for its profile of EXT_lights_ies.
std::optional<GltfLight> source_of(const CheckedGltf& checked, int node) {
  if (const auto found = checked.node_lights.find(node); found != checked.node_lights.end())
    return checked.lights[found->second];
  const auto found = checked.profile_lights.find(node);
  if (found == checked.profile_lights.end()) return std::nullopt;
  GltfLight light;
  light.name = checked.light_profiles[found->second.profile].name;
  light.color = found->second.color * static_cast<float>(found->second.multiplier);
  return light;
}

/// A light while it is read, and where its settings come from.
struct LightInput {
  const GltfModel& model;
  const LightSetting setting;  ///< The job's.
  const int node, named;
  const GltfLight source;
  const std::string where;  ///< In the scene, for errors.

  /// Properties of the node, of the node whose name the user knows, and of the light.
  std::array<const GltfLightExtras*, 3> extras() const {
    const auto& of_nodes = model.checked.node_light_extras;
    return {&of_nodes.at(node), &of_nodes.at(named), &source.extras};
  }

  /// The first value that the job, the node and the light give.
  double size(const std::optional<double>& in_job, std::optional<double> GltfLightExtras::*size) const {
    if (in_job) return *in_job;
    for (const GltfLightExtras* one : extras())
      if (one->*size) return *(one->*size);
    return 0.0;
  }
};

/// A photometric file with the light's colour; null: none.
struct ColoredFile {
  const PhotometricFile* file = nullptr;
  Color color{1.0f};
};

ColoredFile photometric_file(const LightInput& input, const std::string& group, PhotometricFiles& files) {
  const auto [own, named, light] = input.extras();
  const Color& color = input.source.color;
  if (!input.setting.ies.empty()) return {&files.of_job(group, input.setting.ies), color};
  for (const GltfLightExtras* one : {own, named})
    if (!one->ies.empty()) return {&files.at_uri(one->ies, input.where), color};
  const auto& profiles = input.model.checked.profile_lights;
  if (const auto found = profiles.find(input.node); found != profiles.end())
    return {&files.of_profile(found->second.profile), found->second.color * float(found->second.multiplier)};
  if (!light->ies.empty()) return {&files.at_uri(light->ies, input.where), color};
  return {};
}

/// Gives a light the distribution of a photometric file. Nothing if its transform has no axes.
bool make_photometric(const ColoredFile& colored, const Matrix4& to_world, const std::string& where, Light& light) {
  const Vec3d nadir = light.direction;
  const Vec3d side(to_world[0][0], to_world[0][1], to_world[0][2]);
  const Vec3d across = side - nadir * (side ^ nadir);
  if (!(across.length() > 0.0) || !std::isfinite(across.length())) return false;
  const Photometry& photometry = colored.file->photometry;
  const double tilt = std::acos(std::clamp(-nadir.y, -1.0, 1.0)) * 180 / kPi;
  const double strength = photometry.candela / kLumensPerWatt * photometry.tilt_factor(tilt);
  const double largest = strength * double(std::max({colored.color.x, colored.color.y, colored.color.z}));
  if (!(largest <= kMaxStrength))
    throw Error(ExitCode::bad_data, "a photometric light of a strength that no number holds", where,
                "lower its `multiplier` or colour");
  light.strength = colored.color * static_cast<float>(strength);
  light.kind = Light::Kind::point;
  light.inner = light.outer = 0.0;
  light.distribution = colored.file->distribution;
  light.across = across.normalized();
  return true;
}

}  // namespace

std::optional<PlacedLight> placed_light(const GltfModel& model, const Job& job, const std::vector<std::string>& names,
                                        int node, const Matrix4& to_world, PhotometricFiles& files,
                                        Progress& progress) {
  const std::optional<GltfLight> source = source_of(model.checked, node);
  if (!source) return std::nullopt;
  const int named = named_node(model, node);
  PlacedLight placed{source->light, group_of(model, job, node, named, *source, names[named])};
  Light& light = placed.light;
  light.name = names[named];
  if (is_excluded(job.nodes, light.name)) return std::nullopt;
  const auto setting = job.lights.find(placed.group);
  const LightInput input{model,   setting == job.lights.end() ? LightSetting() : setting->second,
                         node,    named,
                         *source, fmt::format("nodes[{}] '{}'", node, names[node])};
  const ColoredFile colored = photometric_file(input, placed.group, files);
  if (colored.file && light.kind == Light::Kind::sun)
    throw Error(ExitCode::bad_data, fmt::format("the sun '{}' has a photometric file", light.name),
                model.file.name + ", " + input.where, "photometric files are for point lights and spots");
  if (job.import.punctual_units != "raw") light.strength /= kLumensPerWatt;
  if (!colored.file && light.strength == Color(0.0f)) return std::nullopt;
  if (light.kind == Light::Kind::sun)
    light.outer = input.size(input.setting.angle, &GltfLightExtras::angle) * kPi / 360;
  else
    light.radius = input.size(input.setting.radius, &GltfLightExtras::radius);
  const Vec3d forward(-to_world[2][0], -to_world[2][1], -to_world[2][2]);
  if (light.kind != Light::Kind::sun) light.position = {to_world[3][0], to_world[3][1], to_world[3][2]};
  for (int k = 0; k < 3; ++k)
    if (!(std::abs(light.position[k]) <= kMaxDistance) || !std::isfinite(forward[k]))
      throw Error(ExitCode::bad_data, "the position or direction of a light is not finite or too far away",
                  model.file.name + ", " + input.where, "correct the node's transform");
  if (light.kind == Light::Kind::point && !colored.file) return placed;
  const bool has_direction = forward.length() > 0.0;
  if (has_direction) light.direction = forward.normalized();
  if (!has_direction || (colored.file && !make_photometric(colored, to_world, input.where, light))) {
    progress.warning(
        fmt::format("light '{}' is skipped: its transform has no direction: its local {} axis has length 0", light.name,
                    has_direction ? "X" : "Z"));
    return std::nullopt;
  }
  if (light.strength == Color(0.0f)) return std::nullopt;
  return placed;
}

void check_light_settings(const GltfModel& model, const Job& job, const GltfScene& scene) {
  const auto has_surface = [&](const std::string& group) {
    return std::any_of(scene.surfaces.begin(), scene.surfaces.end(), [&](const Surface& surface) {
      return surface.light_group >= 0 && scene.light_groups[surface.light_group] == group;
    });
  };
  for (const auto& [name, setting] : job.lights) {
    const auto refuse = [&](const std::string& what, const char* key, const std::string& mend) {
      throw Error(ExitCode::bad_config, what, fmt::format("{}, lights.{}.{}", job.file.string(), name, key), mend);
    };
    const auto has = [&](bool suns) {
      return std::any_of(scene.lights.begin(), scene.lights.end(), [&](const Light& light) {
        return (light.kind == Light::Kind::sun) == suns && scene.light_groups[light.light_group] == name;
      });
    };
    const auto check = [&](bool is_set, const char* key, bool is_of_suns) {
      if (is_set && !has(is_of_suns))
        refuse(
            fmt::format("the light group `{}` has no {}", name, is_of_suns ? "sun" : "point light or spot"), key,
            fmt::format("remove the setting; the scene's light groups are: {}", fmt::join(scene.light_groups, ", ")));
    };
    if (!setting.ies.empty() && has_surface(name))
      refuse(fmt::format("the light group `{}` has emissive surfaces, and photometric files are for point lights and "
                         "spots",
                         name),
             "ies", "give the point lights a light group of their own");
    check(setting.radius.has_value(), "radius", false);
    check(setting.angle.has_value(), "angle", true);
    check(!setting.ies.empty(), "ies", false);
  }
  for (const Surface& surface : scene.surfaces) {
    const auto found = model.checked.node_light_extras.find(surface.node);
    if (surface.light_group < 0 || found == model.checked.node_light_extras.end() || found->second.ies.empty() ||
        source_of(model.checked, surface.node))
      continue;
    throw Error(ExitCode::bad_data, "an emissive mesh has a photometric file",
                fmt::format("{}, nodes[{}] '{}'.extras.ies", model.file.name, surface.node, scene.nodes[surface.node]),
                "photometric files are for point lights and spots");
  }
}

}  // namespace patchlight
