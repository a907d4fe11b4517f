#pragma once
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace patchlight {

/// Splits a key such as `a."b.c".d` at its dots into {a, b.c, d}; empty if it is malformed. Inside quotes, a backslash
/// escapes a quote or a backslash.
std::vector<std::string> split_key(const std::string& key);

/// One `--set key.path=value`: its path and its value as YAML.
struct Override {
  /// Throws: Error (usage) if it is malformed.
  explicit Override(const std::string& set);

  /// The value nested in one map per part of the path, from part `depth` on.
  YAML::Node nested(std::size_t depth) const;

  std::vector<std::string> path;
  YAML::Node value;
};

}  // namespace patchlight
