#include "importers/gltf/check/light_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace patchlight {
namespace {

constexpr const char* kExtension = "KHR_lights_punctual";
constexpr const char* kProfileExtension = "EXT_lights_ies";
constexpr const char* kProfileList = "EXT_lights_ies.lights";  // for messages
constexpr double kRounding = 1e-6;                             // rad; error of pi/2 stored as a float

/// Checks and returns a number that is not negative.
double non_negative(const Json& object, const char* key, double fallback, const GltfPlace& place) {
  check_number(object, key, place);
  const Json* member = find_member(object, key);
  const double value = member ? member->get<double>() : fallback;
  if (!(value >= 0.0)) refuse_gltf(fmt::format("is {}; it must not be negative", value), place, key);
  return value;
}

std::optional<Light::Kind> kind_of(const Json& item, const GltfPlace& place) {
  check_string(item, "type", place);
  const std::string type = string_member(item, "type");
  if (type.empty()) refuse_gltf("has no type", place);
  if (type == "point") return Light::Kind::point;
  if (type == "spot") return Light::Kind::spot;
  if (type == "directional") return Light::Kind::sun;
  return std::nullopt;
}

void read_cone(const Json& item, Light& light, const GltfPlace& place) {
  const Json* spot = find_object(item, "spot", place);
  if (!spot) refuse_gltf("is a spot light without cone angles", place, "spot");
  light.inner = non_negative(*spot, "innerConeAngle", 0.0, place);
  light.outer = non_negative(*spot, "outerConeAngle", kPi / 4, place);
  // Equal angles are allowed: Blender writes them for a sharp edge.
  if (light.inner > light.outer || light.outer > kPi / 2 + kRounding)
    refuse_gltf(
        fmt::format("has cone angles of {} and {}; required is inner <= outer <= pi/2", light.inner, light.outer),
        place, "spot");
}

std::optional<double> number_in_extras(const Json& extras, const char* key, double most, const GltfPlace& place) {
  const Json* member = find_member(extras, key);
  if (!member) return std::nullopt;
  const double value = member->is_number() ? member->get<double>() : -1.0;
  if (!(value >= 0.0 && value <= most))
    refuse_gltf(fmt::format("must be a number in [0, {}]", most), place, fmt::format("extras.{}", key));
  return value;
}

GltfLightExtras checked_extras(const Json& item, const GltfPlace& place) {
  const Json* extras = find_member(item, "extras");
  if (!extras || !extras->is_object()) return {};
  check_string(*extras, "ies", place);
  return {number_in_extras(*extras, "radius", kMaxLightRadius, place),
          number_in_extras(*extras, "angle", kMaxSunAngle, place), string_member(*extras, "ies")};
}

GltfLight checked_light(const Json& item, const GltfPlace& place) {
  GltfLight result;
  const std::optional<Light::Kind> kind = kind_of(item, place);
  check_string(item, "name", place);
  result.name = string_member(item, "name");
  check_numbers(item, "color", 3, place);
  const double intensity = non_negative(item, "intensity", 1.0, place);
  const Json* color = find_member(item, "color");
  for (int k = 0; k < 3; ++k) {
    const double strength = intensity * (color ? (*color)[k].get<double>() : 1.0);
    if (!(strength >= 0.0 && strength <= 3e38))
      refuse_gltf(fmt::format("has a strength (intensity x color) of {}; it must be finite and not negative", strength),
                  place, "color");
    result.light.strength[k] = static_cast<float>(strength);
    if (color) result.color[k] = std::max(0.0f, (*color)[k].get<float>());
  }
  if (item.contains("range") && !(non_negative(item, "range", 1.0, place) > 0.0))
    refuse_gltf("must be greater than 0", place, "range");
  const Json* extras = find_member(item, "extras");
  if (extras && extras->is_object()) result.light_group = string_member(*extras, "light_group");
  result.extras = checked_extras(item, place);
  result.known = kind.has_value();
  result.light.kind = kind.value_or(Light::Kind::point);
  if (result.light.kind == Light::Kind::spot) read_cone(item, result.light, place);
  return result;
}

}  // namespace

std::vector<GltfLight> checked_lights(GltfLists& gltf) {
  std::vector<GltfLight> lights;
  const Json* extension = find_extension(gltf.root, kExtension, {gltf.file});
  const Json* list = extension ? find_array(*extension, "lights", {gltf.file}) : nullptr;
  for (std::size_t i = 0; list && i < list->size(); ++i) {
    const Json& item = (*list)[i];
    const GltfPlace place{gltf.file, kLightList, i, &item};
    if (!item.is_object()) refuse_gltf("must be an object", {gltf.file, kLightList, i});
    lights.push_back(checked_light(item, place));
    if (!lights.back().known) gltf.ignored.insert("lights of unknown types are ignored");
  }
  return lights;
}

std::map<int, int> checked_node_lights(const GltfLists& gltf, const std::vector<GltfLight>& lights) {
  std::map<int, int> result;
  gltf.each("nodes", [&](const Json& node, const GltfPlace& place) {
    const Json* extension = find_extension(node, kExtension, place);
    const int light = extension ? index_member(*extension, "light", lights.size(), place) : -1;
    if (light >= 0 && lights[light].known) result.emplace(static_cast<int>(place.index), light);
  });
  return result;
}

std::vector<GltfData> checked_light_profiles(const GltfLists& gltf) {
  std::vector<GltfData> profiles;
  const Json* extension = find_extension(gltf.root, kProfileExtension, {gltf.file});
  const Json* list = extension ? find_array(*extension, "lights", {gltf.file}) : nullptr;
  for (std::size_t i = 0; list && i < list->size(); ++i) {
    const Json& item = (*list)[i];
    const GltfPlace place{gltf.file, kProfileList, i, &item};
    if (!item.is_object()) refuse_gltf("must be an object", {gltf.file, kProfileList, i});
    for (const char* key : {"uri", "name", "mimeType"}) check_string(item, key, place);
    GltfData data{string_member(item, "name"), string_member(item, "uri"),
                  index_member(item, "bufferView", gltf.count("bufferViews"), place)};
    if (data.uri.empty() == (data.buffer_view < 0)) refuse_gltf("must have either a uri or a bufferView", place);
    profiles.push_back(std::move(data));
  }
  return profiles;
}

std::map<int, GltfProfileLight> checked_profile_lights(const GltfLists& gltf, std::size_t profiles) {
  std::map<int, GltfProfileLight> result;
  gltf.each("nodes", [&](const Json& node, const GltfPlace& place) {
    const Json* extension = find_extension(node, kProfileExtension, place);
    if (!extension) return;
    const int profile = index_member(*extension, "light", profiles, place);
    if (profile < 0) refuse_gltf("has no light", place, kProfileExtension);
    GltfProfileLight light{static_cast<std::size_t>(profile), non_negative(*extension, "multiplier", 1.0, place)};
    check_numbers(*extension, "color", 3, place);
    const Json* color = find_member(*extension, "color");
    for (int k = 0; k < 3 && color; ++k) light.color[k] = std::clamp((*color)[k].get<float>(), 0.0f, 1.0f);
    result.emplace(static_cast<int>(place.index), light);
  });
  return result;
}

std::map<int, GltfLightExtras> checked_light_extras(const GltfLists& gltf, const CheckedGltf& checked) {
  std::map<int, GltfLightExtras> result;
  const auto read = [&](int node) {
    if (node < 0) return;
    const GltfPlace place = gltf.place("nodes", static_cast<std::size_t>(node));
    result[node] = checked_extras(*place.item, place);
  };
  gltf.each("nodes", [&](const Json& node, const GltfPlace& place) {
    const Json* extras = find_member(node, "extras");
    if (node.contains("mesh") && extras && extras->is_object())
      result[static_cast<int>(place.index)].ies = string_member(*extras, "ies");
  });
  const auto read_with_parent = [&](int node) {
    read(node);
    const int parent = checked.parents[node];
    const auto name = [&](int of) { return string_member(*gltf.place("nodes", std::size_t(of)).item, "name"); };
    if (parent >= 0 && name(node) == name(parent) + "_Orientation") read(parent);  // Blender's, of the light's object
  };
  for (const auto& [node, light] : checked.node_lights) read_with_parent(node);
  for (const auto& [node, light] : checked.profile_lights) read_with_parent(node);
  return result;
}

}  // namespace patchlight
