#include <algorithm>

#include "pipeline/job/schema/job_schema.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

constexpr std::size_t kMaxVariants = 10'000;

std::string word(const Node& node) {
  if (!node.IsScalar() || node.Scalar().empty()) throw std::string("expected names");
  return node.Scalar();
}

/// `key: [value, ...]`: one setting; its values are also their names.
MatrixAxis read_values(const Node& name, const Node& values) {
  MatrixAxis axis{word(name), {}};
  for (const Node& value : values) {
    check_setting(axis.name, value, name.Mark());
    const std::string text = flow_text(value);
    axis.choices.push_back({text, {{axis.name, text}}});
  }
  return axis;
}

/// `axis: {name: {key: value, ...}, ...}`: several settings under each name.
MatrixAxis read_choices(const Node& name, const Node& choices) {
  MatrixAxis axis{word(name), {}};
  for (const auto& entry : choices) {
    MatrixAxis::Choice choice{word(entry.first), {}};
    if (!entry.second.IsMap() && !entry.second.IsNull())
      throw EntryFault{"bad value of `matrix." + axis.name + "." + choice.name + "`",
                       "expected a map of settings such as {trace.samples: 4}", entry.first.Mark()};
    for (const auto& setting : entry.second) {
      check_setting(word(setting.first), setting.second, setting.first.Mark());
      choice.settings.emplace_back(setting.first.Scalar(), flow_text(setting.second));
    }
    axis.choices.push_back(std::move(choice));
  }
  return axis;
}

void read_matrix(const Node& map, std::vector<MatrixAxis>& matrix) {
  matrix.clear();
  if (!map.IsMap()) throw std::string("expected a map of axes such as {import.patch_area: [4.0e-3, 1.0e-3]}");
  std::size_t variants = 1;
  for (const auto& entry : map) {
    if (!entry.second.IsSequence() && !entry.second.IsMap())
      throw EntryFault{"bad value of `matrix." + word(entry.first) + "`",
                       "expected a list of values, or a map of names with settings", entry.first.Mark()};
    matrix.push_back(entry.second.IsSequence() ? read_values(entry.first, entry.second)
                                               : read_choices(entry.first, entry.second));
    const std::size_t choices = matrix.back().choices.size();
    if (choices == 0)
      throw EntryFault{"`matrix." + matrix.back().name + "` is empty", "give it a value, or leave it out",
                       entry.first.Mark()};
    variants = std::min(variants * choices, kMaxVariants + 1);
  }
  if (variants > kMaxVariants) throw "expected at most " + std::to_string(kMaxVariants) + " combinations";
}

Node matrix_node(const std::vector<MatrixAxis>& matrix) {
  Node map(YAML::NodeType::Map);
  for (const MatrixAxis& axis : matrix)
    for (const auto& choice : axis.choices) {
      map[axis.name][choice.name] = Node(YAML::NodeType::Map);
      for (const auto& [key, value] : choice.settings) map[axis.name][choice.name][key] = YAML::Load(value);
    }
  return map;
}

}  // namespace

JobKey matrix_key(std::vector<MatrixAxis>& matrix) {
  return {"matrix",
          "axes of variants, each `key: [values]` or `name: {choice: {key: value, ...}, ...}`; `run` makes every "
          "combination",
          [&matrix](const Node& n) { read_matrix(n, matrix); }, [&matrix] { return matrix_node(matrix); }};
}

}  // namespace patchlight
