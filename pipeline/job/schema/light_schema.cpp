#include "pipeline/job/light_group_name.h"
#include "pipeline/job/schema/job_schema.h"
#include "pipeline/job/schema/value_parsing.h"
#include "pipeline/model/light.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

void read_lights(const Node& map, std::map<std::string, LightSetting>& lights) {
  read_entries("lights", map, [&](const std::string& name) -> EntryReader {
    LightSetting& light = lights[light_group_name(name)];
    return {{"scale", [&](const Node& n) { light.scale = parse_number(n, 0, 1e30); }},
            {"color", [&](const Node& n) { light.color = parse_color(n, 1e30); }},
            {"radius", [&](const Node& n) { light.radius = parse_number(n, 0, kMaxLightRadius); }},
            {"angle", [&](const Node& n) { light.angle = parse_number(n, 0, kMaxSunAngle); }},
            {"ies", [&](const Node& n) { light.ies = parse<std::string>(n, "a path"); }}};
  });
}

Node lights_node(const std::map<std::string, LightSetting>& lights) {
  Node map(YAML::NodeType::Map);
  for (const auto& [name, light] : lights) {
    map[name]["scale"] = number_node(light.scale);
    const bool has_more = light.radius || light.angle || !light.ies.empty();
    if (!has_more || light.color != Color(1.0f)) map[name]["color"] = vector_node(light.color);
    if (light.radius) map[name]["radius"] = number_node(*light.radius);
    if (light.angle) map[name]["angle"] = number_node(*light.angle);
    if (!light.ies.empty()) map[name]["ies"] = light.ies.string();
  }
  return map;
}

}  // namespace

JobKey lights_key(std::map<std::string, LightSetting>& lights) {
  return {"lights",
          "by light group: scale and color [r,g,b] of its light in frames; radius of its point lights and spots in m; "
          "angle of its suns in degrees; ies, photometric file (.ies, .ldt) of its point lights and spots",
          [&lights](const Node& n) {
            lights.clear();
            read_lights(n, lights);
          },
          [&lights] { return lights_node(lights); }, [&lights](const Node& n) { read_lights(n, lights); }};
}

}  // namespace patchlight
