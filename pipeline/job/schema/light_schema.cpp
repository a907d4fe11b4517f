#include "pipeline/job/light_group_name.h"
#include "pipeline/job/schema/job_schema.h"
#include "pipeline/job/schema/value_parsing.h"
#include "pipeline/model/light.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

constexpr int kLastFrame = 9'999'999;

/// A value, or a map of them by frame. `parse_one` throws std::string, the allowed values.
template <class Value, class ParseOne>
ByFrame<Value> parse_by_frame(const Node& node, const Value& start, ParseOne parse_one) {
  if (!node.IsMap()) return Value(parse_one(node));
  ByFrame<Value> result(start);
  for (const auto& entry : node) {
    const int frame = int(parse_integer(entry.first, 0, kLastFrame));
    if (!result.keys.emplace(frame, parse_one(entry.second)).second)
      throw "expected each frame once: " + std::to_string(frame) + " comes again";
  }
  if (result.keys.empty()) throw std::string("expected a value, or values by frame: {1: 0, 25: 2}");
  return result;
}

template <class Value, class ToNode>
Node by_frame_node(const ByFrame<Value>& value, ToNode to_node) {
  if (value.keys.empty()) return to_node(value.constant);
  Node map(YAML::NodeType::Map);
  map.SetStyle(YAML::EmitterStyle::Flow);
  for (const auto& [frame, one] : value.keys) map[frame] = to_node(one);
  return map;
}

void read_lights(const Node& map, std::map<std::string, LightSetting>& lights) {
  read_entries("lights", map, [&](const std::string& name) -> EntryReader {
    LightSetting& light = lights[light_group_name(name)];
    const auto scale = [](const Node& n) { return parse_number(n, 0, 1e30); };
    const auto color = [](const Node& n) { return parse_color(n, 1e30); };
    return {{"scale", [&light, scale](const Node& n) { light.scale = parse_by_frame(n, 1.0, scale); }},
            {"color", [&light, color](const Node& n) { light.color = parse_by_frame(n, Color(1.0f), color); }},
            {"radius", [&](const Node& n) { light.radius = parse_number(n, 0, kMaxLightRadius); }},
            {"angle", [&](const Node& n) { light.angle = parse_number(n, 0, kMaxSunAngle); }},
            {"ies", [&](const Node& n) { light.ies = parse<std::string>(n, "a path"); }}};
  });
}

Node lights_node(const std::map<std::string, LightSetting>& lights) {
  Node map(YAML::NodeType::Map);
  for (const auto& [name, light] : lights) {
    map[name]["scale"] = by_frame_node(light.scale, [](double scale) { return number_node(scale); });
    const bool has_more = light.radius || light.angle || !light.ies.empty();
    if (!has_more || light.color != ByFrame(Color(1.0f)))
      map[name]["color"] = by_frame_node(light.color, [](const Color& color) { return vector_node(color); });
    if (light.radius) map[name]["radius"] = number_node(*light.radius);
    if (light.angle) map[name]["angle"] = number_node(*light.angle);
    if (!light.ies.empty()) map[name]["ies"] = light.ies.string();
  }
  return map;
}

}  // namespace

JobKey lights_key(std::map<std::string, LightSetting>& lights) {
  return {"lights",
          "by light group: scale and color [r,g,b] of its light in frames, or maps of them by frame; radius of its "
          "point lights and spots in m; "
          "angle of its suns in degrees; ies, photometric file (.ies, .ldt) of its point lights and spots",
          [&lights](const Node& n) {
            lights.clear();
            read_lights(n, lights);
          },
          [&lights] { return lights_node(lights); }, [&lights](const Node& n) { read_lights(n, lights); }};
}

}  // namespace patchlight
