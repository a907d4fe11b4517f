#pragma once
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

// Each throws std::string, the allowed values, for any other value.

template <class T>
T parse(const YAML::Node& node, const std::string& expected) {
  try {
    return node.as<T>();
  } catch (const YAML::Exception&) {
    throw "expected " + expected;
  }
}

/// Finite; `high` may be infinity.
double parse_number(const YAML::Node& node, double low, double high);

std::int64_t parse_integer(const YAML::Node& node, std::int64_t low, std::int64_t high);

/// A point or a direction, [x, y, z].
Vec3d parse_vector(const YAML::Node& node);

/// [red, green, blue], each from 0 to `high`.
Color parse_color(const YAML::Node& node, double high);

std::string parse_choice(const YAML::Node& node, const std::vector<std::string>& choices);

/// A light group's name, as in files.
std::string parse_group(const YAML::Node& node);

/// With the fewest digits that read back as the same value.
template <class Number>
YAML::Node number_node(Number value) {
  return YAML::Node(fmt::format("{}", value));
}

/// Numbers as [a, b, c].
template <class Vector>
YAML::Node vector_node(const Vector& vector, int size = 3) {
  YAML::Node node;
  node.SetStyle(YAML::EmitterStyle::Flow);
  for (int k = 0; k < size; ++k) node.push_back(number_node(vector[k]));
  return node;
}

/// In the notation of `--set`.
std::string quoted_if_dotted(const std::string& name);

/// The settings of one name in a map of names, each with its reader.
using EntryReader = std::map<std::string, std::function<void(const YAML::Node&)>>;

/// Reads a map of names with the settings of each. `entry_reader` creates or finds the entry of a name; `check` throws
/// std::string, the remedy, for incompatible settings.
/// Throws: std::string; EntryFault.
void read_entries(const std::string& section, const YAML::Node& map,
                  const std::function<EntryReader(const std::string&)>& entry_reader,
                  const std::function<void(const std::string&)>& check = {});

}  // namespace patchlight
