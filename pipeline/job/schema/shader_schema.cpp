#include "pipeline/job/schema/shader_schema.h"

#include <fmt/format.h>

namespace patchlight {

namespace {

using Node = YAML::Node;

std::string parse_expression(const Node& node) {
  if (!node.IsScalar() || node.Scalar().empty())
    throw std::string("expected an expression, or three: [red, green, blue]");
  return node.Scalar();
}

/// A single expression applies to all three channels.
ColorExpressions parse_expressions(const Node& node) {
  ColorExpressions color;
  if (node.IsSequence() && node.size() != 3) throw std::string("expected three expressions [red, green, blue]");
  for (std::size_t k = 0; k < 3; ++k) color[k] = parse_expression(node.IsSequence() ? node[k] : node);
  return color;
}

Node expressions_node(const ColorExpressions& color) {
  Node node;
  node.SetStyle(YAML::EmitterStyle::Flow);
  for (const auto& expression : color) node.push_back(expression);
  return node;
}

Shader parse_shader(const std::string& name, const Node& settings) {
  if (!settings.IsMap()) throw "expected a map of settings for `" + name + "`";
  Shader shader{name, {}, {}};
  for (const auto& setting : settings) {
    const std::string key = setting.first.IsScalar() ? setting.first.Scalar() : "";
    if (key == "reflectance")
      shader.reflectance = parse_expressions(setting.second);
    else if (key == "emission")
      shader.emission = parse_expressions(setting.second);
    else
      throw fmt::format("unknown key `{}` of `{}`: a shader has `reflectance` and `emission`", key, name);
  }
  return shader;
}

}  // namespace

void read_shaders(const Node& map, std::vector<Shader>& shaders) {
  shaders.clear();
  if (!map.IsMap()) throw std::string("expected a map of material or node names");
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) throw std::string("expected the name of a material or node");
    shaders.push_back(parse_shader(entry.first.Scalar(), entry.second));
  }
}

Node shaders_node(const std::vector<Shader>& shaders) {
  Node map(YAML::NodeType::Map);
  for (const auto& shader : shaders) {
    map[shader.name] = Node(YAML::NodeType::Map);
    if (is_set(shader.reflectance)) map[shader.name]["reflectance"] = expressions_node(shader.reflectance);
    if (is_set(shader.emission)) map[shader.name]["emission"] = expressions_node(shader.emission);
  }
  return map;
}

}  // namespace patchlight
