#include "pipeline/job/schema/job_override.h"

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

[[noreturn]] void refuse_set(const std::string& set) {
  throw Error(ExitCode::usage, "malformed override", "--set " + set,
              "write --set key.path=value, and a key that holds dots in double quotes");
}

bool escapes(const std::string& text, std::size_t i) {
  return text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\');
}

/// End of the key at the beginning of `text`: the first `=` outside of quotes, or npos.
std::size_t key_end(const std::string& text) {
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quoted && escapes(text, i))
      ++i;
    else if (text[i] == '"')
      quoted = !quoted;
    else if (text[i] == '=' && !quoted)
      return i;
  }
  return std::string::npos;
}

}  // namespace

std::vector<std::string> split_key(const std::string& key) {
  std::vector<std::string> path(1);
  bool quoted = false;
  for (std::size_t i = 0; i < key.size(); ++i) {
    if (quoted && escapes(key, i))
      path.back() += key[++i];
    else if (key[i] == '"')
      quoted = !quoted;
    else if (quoted || key[i] != '.')
      path.back() += key[i];
    else if (path.back().empty())
      return {};
    else
      path.emplace_back();
  }
  if (quoted || path.back().empty()) return {};
  return path;
}

Override::Override(const std::string& set) {
  const std::size_t equals = key_end(set);
  if (equals != std::string::npos) path = split_key(set.substr(0, equals));
  if (path.empty()) refuse_set(set);
  try {
    value = YAML::Load(set.substr(equals + 1));
  } catch (const YAML::Exception&) {
    refuse_set(set);
  }
  if (!value.IsDefined() || value.IsNull()) refuse_set(set);
}

YAML::Node Override::nested(std::size_t depth) const {
  YAML::Node node = value;
  for (std::size_t i = path.size(); i > depth; --i) {
    YAML::Node map(YAML::NodeType::Map);
    map[path[i - 1]] = node;
    node.reset(map);
  }
  return node;
}

}  // namespace patchlight
