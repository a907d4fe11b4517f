#include "pipeline/job/reader/job_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "pipeline/job/blender/blender_export.h"
#include "pipeline/job/nearest_word.h"
#include "pipeline/job/reader/scene_file.h"
#include "pipeline/job/schema/job_override.h"
#include "pipeline/job/schema/job_schema.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxJobBytes = 1 << 20;
constexpr std::size_t kMaxEntries = 1 << 20;  // aliases can make far more of few bytes
constexpr int kJobLevels = 3;
constexpr int kIncludeLevels = 8, kMaxIncludes = 100;
constexpr std::int64_t kMaxPixels = 1 << 28;

[[noreturn]] void refuse(const fs::path& file, const YAML::Mark& mark, const std::string& what,
                         const std::string& mend) {
  throw Error(ExitCode::bad_config, what, fmt::format("{}, line {}", file.string(), mark.line + 1), mend);
}

/// Refuses keys that stand twice in one map: of which the later would hide the earlier from its reader. Deeper than
/// jobs reach nothing is looked at.
void refuse_duplicates(const fs::path& file, const YAML::Node& map, int levels, std::size_t& budget) {
  if (levels == 0 || !map.IsMap()) return;
  std::set<std::string> names;
  for (const auto& entry : map) {
    if (budget-- == 0) refuse(file, map.Mark(), "more entries than a job can have", "is it a job file?");
    if (entry.first.IsScalar() && !names.insert(entry.first.Scalar()).second)
      refuse(file, entry.first.Mark(), "the key `" + entry.first.Scalar().substr(0, 100) + "` stands twice",
             "keep one of them");
    refuse_duplicates(file, entry.second, levels - 1, budget);
  }
}

YAML::Node parse_yaml(const fs::path& file, const std::string& text) {
  try {
    YAML::Node root = YAML::Load(text);
    if (root.IsNull()) root = YAML::Node(YAML::NodeType::Map);
    if (!root.IsMap()) refuse(file, root.Mark(), "not a map of keys", "begin with `scene: FILE.glb`");
    std::size_t budget = kMaxEntries;
    refuse_duplicates(file, root, kJobLevels, budget);
    return root;
  } catch (const YAML::Exception& error) {
    refuse(file, error.mark, "not valid YAML: " + error.msg, "mend the syntax");
  }
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
  return parse_yaml(file, text.str());
}

std::vector<fs::path*> all_paths(Job& job) {
  std::vector<fs::path*> paths = job.input_files();
  for (fs::path* path : {&job.scene, &job.output, &job.bench.reference}) paths.push_back(path);
  return paths;
}

/// Reads a job from its file and then from one override after the other, so that each fault has a place of its own.
class JobReader {
 public:
  JobReader(const fs::path& file, Job& job, bool merges = false)
      : file_(file), job_(job), keys_(job_keys(job)), merges_(merges) {}

  bool merges() const { return merges_; }

  /// Reads the files that this one includes, and then this one over them.
  void read_file(int& budget, int levels = kIncludeLevels) {
    const YAML::Node root = load_yaml(file_);
    const YAML::Node include = root["include"];
    const fs::path folder = fs::absolute(file_).parent_path();
    for (const std::string& name : included(include)) {
      if (levels == 0 || budget-- == 0)
        refuse(file_, include.Mark(), "too many files that include each other", "does one include itself?");
      const fs::path other = folder / name;
      std::error_code fault;
      if (!fs::is_regular_file(other, fault))
        throw Error(ExitCode::missing_input, "missing job file " + other.string(),
                    fmt::format("{}, line {}, include", file_.string(), include.Mark().line + 1), "check the path");
      JobReader(other, job_).read_file(budget, levels - 1);
      merges_ = true;
    }
    read_section(root, "");
    for (fs::path* path : all_paths(job_))
      if (!path->empty()) *path = folder / *path;  // as they stand: `link/..` is not the folder that holds the link
  }

  void read_text(const std::string& text) { read_section(parse_yaml(file_, text), ""); }

  void apply(const std::string& set) {
    const Override change(set);
    if (change.path[0] == "include")
      throw Error(ExitCode::bad_config, "`include` stands in job files alone", "--set " + set, "include it there");
    set_ = &set;
    const auto key = std::find_if(keys_.begin(), keys_.end(),
                                  [&](const JobKey& k) { return k.path == change.path[0] && k.read_some; });
    if (key == keys_.end() || change.path.size() == 1)
      read_section(change.nested(0), "");
    else
      read_value(key->path, key->read_some, YAML::Node(), change.nested(1));
    set_ = nullptr;
  }

 private:
  [[noreturn]] void refuse_entry(const YAML::Mark& mark, const std::string& what, const std::string& mend) const {
    if (set_) throw Error(ExitCode::bad_config, what, file_.string() + ", --set " + *set_, mend);
    refuse(file_, mark, what, mend);
  }

  std::vector<std::string> included(const YAML::Node& include) const {
    try {
      if (!include.IsDefined() || include.IsNull()) return {};
      if (include.IsScalar()) return {include.Scalar()};
      return include.as<std::vector<std::string>>();
    } catch (const YAML::Exception&) {
      refuse(file_, include.Mark(), "bad value of `include`", "expected a path or a list of paths");
    }
  }

  void read_section(const YAML::Node& map, const std::string& prefix) const {
    for (const auto& entry : map) {
      const YAML::Mark mark = entry.first.Mark();
      if (!entry.first.IsScalar()) refuse_entry(mark, "a key that is not a word", "write `key: value`");
      const std::string path = prefix + entry.first.Scalar().substr(0, 100);
      const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const JobKey& k) { return k.path == path; });
      const bool section = prefix.empty() && std::any_of(keys_.begin(), keys_.end(), [&](const JobKey& k) {
                             return k.path.starts_with(path + ".");
                           });
      if (key == keys_.end() && !section)
        refuse_entry(mark, "unknown key `" + path + "`", "did you mean `" + nearest_key(path) + "`?");
      if (entry.second.IsNull()) continue;  // `key:` without a value keeps the default
      if (section && !entry.second.IsMap())
        refuse_entry(mark, "bad value of `" + path + "`", "expected a map of settings");
      if (section)
        read_section(entry.second, path + ".");
      else
        read_value(path, merges_ && key->read_some ? key->read_some : key->read, entry.first, entry.second);
    }
  }

  void read_value(const std::string& path, const JobKey::Read& read, const YAML::Node& name,
                  const YAML::Node& value) const {
    try {
      read(value);
    } catch (const std::string& expected) {
      refuse_entry(name.Mark(), "bad value of `" + path + "`", expected);
    } catch (const EntryFault& fault) {
      refuse_entry(fault.mark, fault.what, fault.mend);
    }
  }

  std::string nearest_key(const std::string& path) const {
    std::vector<std::string> paths;
    for (const JobKey& key : keys_) paths.push_back(key.path);
    return nearest_word(paths, path);
  }

  const fs::path& file_;
  Job& job_;
  std::vector<JobKey> keys_;
  bool merges_;  ///< Keys that are maps of names add entries to the map read so far, instead of replacing it.
  const std::string* set_ = nullptr;  ///< The override that is being read; null: the file.
};

/// The job that a scene stands for; its paths are relative to the scene's folder.
Job scene_job(const fs::path& scene) {
  std::error_code fault;
  if (!fs::is_regular_file(scene, fault))
    throw Error(ExitCode::missing_input, "missing scene", scene.string(), "check the path");
  Job job;
  job.scene = scene.filename();
  job.output = scene.stem();
  job.output += ".patchlight";
  return job;
}

}  // namespace

Job read_job(const fs::path& file, const std::vector<std::string>& sets, const fs::path& output) {
  return JobTemplate(file).job(sets, output);
}

JobTemplate::JobTemplate(const fs::path& file) {
  const bool is_scene = is_scene_file(file);
  if (is_scene) job_ = scene_job(file);
  job_.file = file;
  if (is_scene) return;
  JobReader reader(file, job_);
  int budget = kMaxIncludes;
  reader.read_file(budget);
  merges_ = reader.merges();
}

Job JobTemplate::job(const std::vector<std::string>& sets, const fs::path& output) const {
  Job job = job_;
  const fs::path& file = job_.file;
  JobReader reader(file, job, merges_);
  for (const auto& set : sets) reader.apply(set);
  if (job.scene.empty()) throw Error(ExitCode::bad_config, "no `scene`", file.string(), "add `scene: FILE.glb`");
  if (!output.empty()) job.output = fs::absolute(output);
  if (job.output.empty()) throw Error(ExitCode::bad_config, "no `output`", file.string(), "add `output: FOLDER`");
  const fs::path folder = fs::absolute(file).parent_path();
  job.scene = folder / job.scene;
  job.output = folder / job.output;
  if (is_blender_file(job.scene)) job = job_over_export(job, sets);
  for (fs::path* path : all_paths(job))
    if (!path->empty()) *path = folder / *path;
  if (const auto& size = job.trace.resolution; size && std::int64_t((*size)[0]) * (*size)[1] > kMaxPixels)
    throw Error(ExitCode::over_limit, fmt::format("a frame of more than {} pixels", kMaxPixels),
                file.string() + ", trace.resolution", "lower it");
  return job;
}

Job JobTemplate::job_over_export(const Job& job, const std::vector<std::string>& sets) const {
  BlenderExport blender = cached_blender_export(job.scene, job.output);
  Job result;
  int budget = kMaxIncludes;
  JobReader(blender.job, result).read_file(budget);
  const fs::path scene = result.scene;
  if (!is_scene_file(job_.file)) JobReader(job_.file, result, true).read_file(budget);
  JobReader reader(job_.file, result, true);
  for (const auto& set : sets) reader.apply(set);
  result.file = job_.file;
  result.scene = scene;
  result.output = job.output;
  result.export_warnings = std::move(blender.warnings);
  return result;
}

std::string effective_job(const Job& job) {
  const fs::path folder = fs::absolute(job.file).parent_path();
  Job copy = job;
  for (fs::path* path : all_paths(copy))
    if (path->string().starts_with(folder.string() + "/")) *path = path->string().substr(folder.string().size() + 1);
  YAML::Node root(YAML::NodeType::Map);
  for (const JobKey& key : job_keys(copy)) {
    if (job.bench.sweep.empty() && key.path.starts_with("bench.")) continue;
    if (job.matrix.empty() && key.path == "matrix") continue;
    if (job.executor == "local" && (key.path == "executor" || key.path.starts_with("slurm."))) continue;
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

Job parse_effective_job(const std::string& text) {
  Job job;
  const fs::path place = "effective job";
  if (text.size() > 4 * kMaxJobBytes) throw Error(ExitCode::bad_config, "too long", place, "");
  JobReader(place, job).read_text(text);
  return job;
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
