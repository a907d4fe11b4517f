#include "pipeline/files/job_override.h"

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

[[noreturn]] void refuse_set(const std::string& set) {
  throw Error(ExitCode::usage, "malformed override", "--set " + set,
              "write --set key.path=value, and a key that holds dots in double quotes");
}

/// The end of the key that `text` begins with: the first `=` outside of quotes, or npos.
std::size_t key_end(const std::string& text) {
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (text[i] == '=' && !quoted) return i;
  }
  return std::string::npos;
}

/// YAML::Node has reference semantics, so each level is a variable of its own.
void put(YAML::Node parent, const std::vector<std::string>& path, std::size_t depth, const YAML::Node& value) {
  YAML::Node child = parent[path[depth]];
  if (depth + 1 == path.size()) {
    parent[path[depth]] = value;
    return;
  }
  if (!child.IsDefined() || !child.IsMap()) parent[path[depth]] = YAML::Node(YAML::NodeType::Map);
  put(parent[path[depth]], path, depth + 1, value);
}

}  // namespace

std::vector<std::string> split_key(const std::string& key) {
  std::vector<std::string> path(1);
  bool quoted = false;
  for (const char c : key) {
    if (c == '"')
      quoted = !quoted;
    else if (quoted || c != '.')
      path.back() += c;
    else if (path.back().empty())
      return {};
    else
      path.emplace_back();
  }
  if (quoted || path.back().empty()) return {};
  return path;
}

void put_key(YAML::Node root, const std::vector<std::string>& path, const YAML::Node& value) {
  put(root, path, 0, value);
}

std::vector<std::string> apply_override(YAML::Node root, const std::string& set) {
  const std::size_t equals = key_end(set);
  const std::vector<std::string> path =
      equals == std::string::npos ? std::vector<std::string>() : split_key(set.substr(0, equals));
  if (path.empty()) refuse_set(set);
  YAML::Node value;
  try {
    value = YAML::Load(set.substr(equals + 1));
  } catch (const YAML::Exception&) {
    refuse_set(set);
  }
  if (!value.IsDefined() || value.IsNull()) refuse_set(set);
  put_key(root, path, value);
  return path;
}

}  // namespace patchlight
