#include "pipeline/job/view_config.h"

#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>
#include <vector>

#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxConfigNodes = 1 << 20;  // aliases can make far more of few bytes
constexpr int kMaxSubstitutions = 16;     // variables that name variables

/// What `$NAME`, `${NAME}` and `%NAME%` stand for in a config, by OpenColorIO's rules: a config that declares variables
/// knows no others.
class Variables {
 public:
  explicit Variables(const YAML::Node& config) {
    const YAML::Node declared = config["environment"];
    for (const auto& entry : declared) {
      if (!entry.first.IsScalar() || !entry.second.IsScalar()) continue;
      const char* value = std::getenv(entry.first.Scalar().c_str());
      add(entry.first.Scalar(), value ? value : entry.second.Scalar());
    }
    for (char** variable = environ; !declared && *variable; ++variable) {
      const std::string text = *variable;
      if (const std::size_t end = text.find('='); end != std::string::npos)
        add(text.substr(0, end), text.substr(end + 1));
    }
    std::sort(values_.begin(), values_.end(),
              [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
  }

  std::string resolve(std::string text) const {
    for (int round = 0; round < kMaxSubstitutions && text.find_first_of("$%") != std::string::npos; ++round) {
      const std::string before = text;
      for (const auto& [name, value] : values_)
        for (const std::string& use : {"${" + name + "}", "$" + name, "%" + name + "%"}) replace(text, use, value);
      if (text == before) break;
    }
    return text;
  }

 private:
  void add(const std::string& name, const std::string& value) {
    if (!name.empty()) values_.emplace_back(name, value);
  }

  static void replace(std::string& text, const std::string& use, const std::string& value) {
    for (std::size_t at = text.find(use); at != std::string::npos; at = text.find(use, at + value.size()))
      text.replace(at, use.size(), value);
  }

  std::vector<std::pair<std::string, std::string>> values_;  ///< Longest names first, as OpenColorIO replaces them.
};

/// Adds what a config stands for beside its own text to a key.
class ConfigWalk {
 public:
  ConfigWalk(const YAML::Node& config, const fs::path& folder, KeyHasher& key) : variables_(config), key_(key) {
    const YAML::Node paths = config["search_path"];
    if (paths && paths.IsSequence()) {
      for (const auto& path : paths)
        if (path.IsScalar()) add_folder(folder, path.Scalar());
    } else if (paths && paths.IsScalar()) {
      std::istringstream text(paths.Scalar());
      for (std::string path; std::getline(text, path, ':');) add_folder(folder, path);
    }
    if (folders_.empty()) folders_.push_back(folder);
    for (const auto& entry : config)
      if (entry.first.IsScalar() && entry.first.Scalar() != "search_path") visit(entry.second);
  }

 private:
  void add_folder(const fs::path& folder, const std::string& path) {
    folders_.push_back(folder / variables_.resolve(path));
  }

  void visit(const YAML::Node& node) {
    if (budget_-- <= 0) return;
    if (node.IsScalar()) {
      if (node.Scalar().find_first_of("$%") != std::string::npos) key_.add(variables_.resolve(node.Scalar()));
    } else if (node.IsMap() && node.Tag() == "FileTransform") {
      if (const YAML::Node file = node["src"]; file && file.IsScalar()) add_file(variables_.resolve(file.Scalar()));
    } else {
      for (const auto& entry : node) visit(node.IsMap() ? entry.second : YAML::Node(entry));
    }
  }

  /// The content of the first file of that name on the search path, and its extension, which tells its format.
  void add_file(const fs::path& name) {
    std::error_code fault;
    for (const fs::path& folder : folders_) {
      if (!fs::is_regular_file(folder / name, fault)) continue;
      key_.add(name.extension().string()).add(hash_file(folder / name));
      return;
    }
    key_.add("missing");
  }

  Variables variables_;
  std::vector<fs::path> folders_;
  KeyHasher& key_;
  int budget_ = kMaxConfigNodes;
};

}  // namespace

fs::path view_config_file(const fs::path& chosen) {
  const char* variable = std::getenv("OCIO");
  const fs::path file = !chosen.empty() ? chosen : variable ? variable : "";
  std::error_code fault;
  if (!file.empty() && !fs::is_regular_file(file, fault))
    throw Error(ExitCode::missing_input, "missing OpenColorIO config", file,
                chosen.empty() ? "set or unset $OCIO" : "mend `trace.ocio`");
  return file;
}

std::string view_config_key(const fs::path& chosen) {
  const fs::path file = view_config_file(chosen);
  if (file.empty()) return "shipped";
  KeyHasher key;
  key.add("view config").add(hash_file(file));
  for (const char* name : {"OCIO_ACTIVE_DISPLAYS", "OCIO_ACTIVE_VIEWS"}) {
    const char* value = std::getenv(name);
    key.add(value ? value : "");
  }
  try {
    const YAML::Node config = YAML::LoadFile(file.string());
    if (config.IsMap()) ConfigWalk(config, fs::absolute(file).parent_path(), key);
  } catch (const YAML::Exception&) {  // an archive, which holds its files itself, or broken, as the trace will tell
  }
  return key.hex();
}

}  // namespace patchlight
