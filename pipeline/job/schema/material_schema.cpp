#include <limits>

#include "pipeline/job/schema/job_schema.h"
#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

/// `section`: materials or nodes.
void read_overrides(const std::string& section, const Node& map, std::vector<MaterialOverride>& overrides) {
  read_entries(section, map, [&](const std::string& name) -> EntryReader {
    std::size_t at = 0;
    while (at < overrides.size() && overrides[at].pattern != name) ++at;
    if (at == overrides.size()) overrides.push_back({name});
    MaterialOverride& change = overrides[at];
    constexpr double kBrightest = std::numeric_limits<float>::max();
    return {{"reflectance", [&](const Node& n) { change.reflectance = parse_color(n, 1); }},
            {"emission", [&](const Node& n) { change.emission = parse_color(n, kBrightest); }},
            {"mirror", [&](const Node& n) { change.mirror = parse_color(n, 1); }},
            {"specular", [&](const Node& n) { change.specular = parse_number(n, 0, 1); }},
            {"roughness", [&](const Node& n) { change.roughness = parse_number(n, 0, 1); }},
            {"ior", [&](const Node& n) { change.ior = parse_number(n, 1, 100); }},
            {"light_group", [&](const Node& n) { change.light_group = parse_group(n); }},
            {"patch_area", [&](const Node& n) { change.patch_area = parse_number(n, 1e-30, 1e30); }},
            {"exclude", [&](const Node& n) { change.exclude = parse<bool>(n, "true or false"); }}};
  });
}

Node overrides_node(const std::vector<MaterialOverride>& overrides) {
  Node map(YAML::NodeType::Map);
  for (const auto& change : overrides) {
    if (change.reflectance) map[change.pattern]["reflectance"] = vector_node(*change.reflectance);
    if (change.emission) map[change.pattern]["emission"] = vector_node(*change.emission);
    if (change.mirror) map[change.pattern]["mirror"] = vector_node(*change.mirror);
    if (change.specular) map[change.pattern]["specular"] = *change.specular;
    if (change.roughness) map[change.pattern]["roughness"] = *change.roughness;
    if (change.ior) map[change.pattern]["ior"] = *change.ior;
    if (change.light_group) map[change.pattern]["light_group"] = *change.light_group;
    if (change.patch_area) map[change.pattern]["patch_area"] = *change.patch_area;
    if (change.exclude) map[change.pattern]["exclude"] = *change.exclude;
  }
  return map;
}

}  // namespace

JobKey overrides_key(const std::string& section, std::vector<MaterialOverride>& overrides, const std::string& help) {
  return {section, help,
          [section, &overrides](const Node& n) {
            overrides.clear();
            read_overrides(section, n, overrides);
          },
          [&overrides] { return overrides_node(overrides); },
          [section, &overrides](const Node& n) { read_overrides(section, n, overrides); }};
}

}  // namespace patchlight
