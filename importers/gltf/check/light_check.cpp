#include "importers/gltf/check/light_check.h"

#include <fmt/format.h>

#include <limits>
#include <optional>

namespace patchlight {
namespace {

constexpr const char* kExtension = "KHR_lights_punctual";
constexpr double kRounding = 1e-6;  // rad; error of pi/2 stored as a float

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
  return {number_in_extras(*extras, "radius", kMaxLightRadius, place),
          number_in_extras(*extras, "angle", kMaxSunAngle, place)};
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

std::map<int, GltfLightExtras> checked_light_extras(const GltfLists& gltf, const std::map<int, int>& node_lights,
                                                    const std::vector<int>& parents) {
  std::map<int, GltfLightExtras> result;
  for (const auto& [light_node, light] : node_lights)
    for (const int node : {light_node, parents[light_node]})
      if (node >= 0) {
        const GltfPlace place = gltf.place("nodes", static_cast<std::size_t>(node));
        result.emplace(node, checked_extras(*place.item, place));
      }
  return result;
}

}  // namespace patchlight
