#pragma once
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace patchlight {

/// Splits a key such as `a."b.c".d` at its dots into {a, b.c, d}; empty if it is malformed.
std::vector<std::string> split_key(const std::string& key);

/// Puts a value into a map of maps, made where they are missing.
void put_key(YAML::Node root, const std::vector<std::string>& path, const YAML::Node& value);

/// Applies `key=value`, the value being YAML, to a job's root. Returns the key's path.
/// Throws: Error (usage) if it is malformed.
std::vector<std::string> apply_override(YAML::Node root, const std::string& set);

}  // namespace patchlight
