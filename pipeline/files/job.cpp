#include "pipeline/files/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>

#include "pipeline/files/job_override.h"
#include "pipeline/files/job_schema.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxJobBytes = 1 << 20;

[[noreturn]] void refuse(const fs::path& file, const YAML::Mark& mark, const std::string& what,
                         const std::string& mend) {
  throw Error(ExitCode::bad_config, what, fmt::format("{}, line {}", file.string(), mark.line + 1), mend);
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t(0));
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (a[i] != b[j])});
      diagonal = above;
    }
  }
  return row.back();
}

const JobKey& nearest_key(const std::vector<JobKey>& keys, const std::string& path) {
  return *std::min_element(keys.begin(), keys.end(), [&](const JobKey& a, const JobKey& b) {
    return edit_distance(a.path, path) < edit_distance(b.path, path);
  });
}

YAML::Node load_yaml(const fs::path& file) {
  std::error_code fault;
  if (!fs::is_regular_file(file, fault))
    throw Error(ExitCode::missing_input, "missing job file", file.string(), "check the path");
  if (fs::file_size(file, fault) > kMaxJobBytes)
    throw Error(ExitCode::bad_config, "job file of more than 1 MiB", file.string(), "is it a job file?");
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream) throw Error(ExitCode::missing_input, "cannot read the job file", file.string(), "check its permissions");
  try {
    YAML::Node root = YAML::Load(text.str());
    if (root.IsNull()) root = YAML::Node(YAML::NodeType::Map);
    if (!root.IsMap()) refuse(file, root.Mark(), "not a map of keys", "begin with `scene: FILE.glb`");
    return root;
  } catch (const YAML::Exception& error) {
    refuse(file, error.mark, "not valid YAML: " + error.msg, "mend the syntax");
  }
}

/// Reads a whole job: of each key it knows whether the file or an override says it.
class JobReader {
 public:
  JobReader(const fs::path& file, YAML::Node root, Job& job) : file_(file), keys_(job_keys(job)), root_(root) {}

  void apply(const std::string& set) {
    std::string path;
    for (const auto& part : apply_override(root_, set)) overridden_.insert(path += (path.empty() ? "" : ".") + part);
  }

  void read() const {
    read_section(root_, "");
    const YAML::Node bench = root_["bench"];
    if (!bench.IsDefined() || !bench.IsMap()) return;
    if (const YAML::Node sweep = bench["sweep"]; sweep.IsDefined() && sweep.IsSequence())
      for (const auto& grid : sweep) check_settings("bench.sweep", grid, true);
    else if (sweep.IsDefined())
      check_settings("bench.sweep", sweep, true);
    if (const YAML::Node settings = bench["reference_settings"]; settings.IsDefined())
      check_settings("bench.reference_settings", settings, false);
  }

 private:
  /// Where a key stands, for people.
  std::string place_of(const std::string& path, const YAML::Node& name) const {
    if (!place_.empty()) return place_;
    if (name.Mark().is_null() || overridden_.contains(path)) return file_.string() + ", --set";
    return fmt::format("{}, line {}", file_.string(), name.Mark().line + 1);
  }

  [[noreturn]] void refuse_entry(const std::string& path, const YAML::Node& name, const std::string& what,
                                 const std::string& mend) const {
    throw Error(ExitCode::bad_config, what, place_of(path, name), mend);
  }

  /// Refuses settings, of key to value or to a list of values, that a job would not take.
  void check_settings(const std::string& path, const YAML::Node& settings, bool lists) const {
    for (const auto& setting : settings) {
      const std::vector<std::string> key = split_key(setting.first.Scalar());
      if (key.empty() || key[0] == "bench" || key[0] == "output")
        refuse_entry(path, setting.first, "`" + setting.first.Scalar() + "` cannot stand in `" + path + "`",
                     "name a key of a stage, as in `solve.rays`");
      Job scratch;
      JobReader reader(file_, YAML::Node(YAML::NodeType::Map), scratch);
      reader.place_ = place_of(path, setting.first);
      const auto check = [&](const YAML::Node& value) {
        put_key(reader.root_, key, value);
        reader.read_section(reader.root_, "");
      };
      if (lists && setting.second.IsSequence())
        for (const auto& value : setting.second) check(value);
      else
        check(setting.second);
    }
  }

  void read_section(const YAML::Node& map, const std::string& prefix) const {
    for (const auto& entry : map) {
      if (!entry.first.IsScalar()) refuse(file_, entry.first.Mark(), "a key that is not a word", "write `key: value`");
      const std::string path = prefix + entry.first.Scalar().substr(0, 100);
      const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const JobKey& k) { return k.path == path; });
      const bool section = prefix.empty() && std::any_of(keys_.begin(), keys_.end(), [&](const JobKey& k) {
                             return k.path.starts_with(path + ".");
                           });
      if (key == keys_.end() && !section)
        refuse_entry(path, entry.first, "unknown key `" + path + "`",
                     "did you mean `" + nearest_key(keys_, path).path + "`?");
      if (entry.second.IsNull()) continue;  // `key:` without a value keeps the default
      if (section && !entry.second.IsMap())
        refuse_entry(path, entry.first, "bad value of `" + path + "`", "expected a map of settings");
      if (section)
        read_section(entry.second, path + ".");
      else
        read_value(*key, entry.first, entry.second);
    }
  }

  void read_value(const JobKey& key, const YAML::Node& name, const YAML::Node& value) const {
    try {
      key.read(value);
    } catch (const std::string& expected) {
      refuse_entry(key.path, name, "bad value of `" + key.path + "`", expected);
    }
  }

  const fs::path& file_;
  std::vector<JobKey> keys_;
  YAML::Node root_;
  std::set<std::string> overridden_;
  std::string place_;  ///< Of all keys; empty: each has its own.
};

}  // namespace

Job read_job(const fs::path& file, const std::vector<std::string>& sets, const fs::path& output) {
  Job job;
  job.file = file;
  JobReader reader(file, load_yaml(file), job);
  for (const auto& set : sets) reader.apply(set);
  reader.read();
  if (job.scene.empty()) throw Error(ExitCode::bad_config, "no `scene`", file.string(), "add `scene: FILE.glb`");
  if (!output.empty()) job.output = fs::absolute(output);
  if (job.output.empty()) throw Error(ExitCode::bad_config, "no `output`", file.string(), "add `output: FOLDER`");
  const fs::path folder = fs::absolute(file).parent_path();
  job.scene = (folder / job.scene).lexically_normal();
  job.output = (folder / job.output).lexically_normal();
  if (!job.bench.reference.empty()) job.bench.reference = (folder / job.bench.reference).lexically_normal();
  return job;
}

std::string effective_job(const Job& job) {
  const fs::path folder = fs::absolute(job.file).parent_path();
  Job copy = job;
  for (fs::path* path : {&copy.scene, &copy.output, &copy.bench.reference})
    if (!path->empty()) *path = path->lexically_relative(folder);
  YAML::Node root(YAML::NodeType::Map);
  for (const JobKey& key : job_keys(copy)) {
    if (job.bench.sweep.empty() && key.path.starts_with("bench.")) continue;
    const YAML::Node value = key.write();
    const std::size_t dot = key.path.find('.');
    if (value.IsScalar() && value.Scalar().empty()) continue;
    if (dot == std::string::npos)
      root[key.path] = value;
    else
      root[key.path.substr(0, dot)][key.path.substr(dot + 1)] = value;
  }
  return YAML::Dump(root);
}

std::string job_key_help() {
  Job defaults;
  std::string help = "Keys of a job file (default):\n";
  for (const JobKey& key : job_keys(defaults)) {
    const std::string value = YAML::Dump(key.write());
    const bool none =
        value.empty() || value == "~" || value == "\"\"" || value == "{}" || value == "[]" || value == "null";
    help += fmt::format("  {:<26}{} ({})\n", key.path, key.help, none ? "none" : value);
  }
  return help;
}

}  // namespace patchlight
