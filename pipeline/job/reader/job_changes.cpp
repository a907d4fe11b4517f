#include "pipeline/job/reader/job_changes.h"

#include <map>
#include <set>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/job/schema/job_schema.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

/// What a stage reads: paths are where things stand and not what they are, and the rest is for the driver.
bool is_setting(const JobKey& key) {
  static const std::set<std::string> others{"scene", "output", "include", "cache", "matrix", "executor"};
  return !others.contains(key.path) && !key.path.starts_with("bench.") && !key.path.starts_with("slurm.");
}

/// A copy of `base` with the setting at `index` as in `other`.
Job mixed(Job base, std::size_t index, Job other) {
  Job result;
  result.scene = base.scene;  // paths are named as they lie from there
  std::vector<JobKey> to = job_keys(result), from = job_keys(base), changed = job_keys(other);
  for (std::size_t i = 0; i < to.size(); ++i) {
    const YAML::Node value = (i == index ? changed : from)[i].write();
    if (is_setting(to[i]) && !value.IsNull()) to[i].read(value);
  }
  return result;
}

/// Values by name below a key, for those that are maps of names.
void flatten(const std::string& path, const YAML::Node& value, std::map<std::string, std::string>& leaves) {
  if (!value.IsMap()) {
    YAML::Emitter text;
    text << YAML::Flow << value;
    leaves[path] = value.IsNull() ? "none" : text.c_str();
    return;
  }
  for (const auto& entry : value) {
    const std::string name = entry.first.Scalar();
    flatten(path + "." + (name.find('.') == std::string::npos ? name : '"' + name + '"'), entry.second, leaves);
  }
}

}  // namespace

Job with_settings_of(const Job& job, const std::string& made_for) {
  if (made_for.empty()) return job;
  try {
    Job result = parse_effective_job(made_for);
    result.scene = job.scene;
    result.output = job.output;
    for (std::filesystem::path* path : result.input_files())
      if (!path->empty()) *path = std::filesystem::absolute(job.file).parent_path() / *path;
    return result;
  } catch (const Error&) {
    return job;
  }
}

std::vector<std::string> changed_settings(const Job& job, const std::string& made_for,
                                          const std::function<std::string(const Job&)>& key_of) {
  Job before = with_settings_of(job, made_for), now = job;
  std::vector<std::string> changes;
  const std::vector<JobKey> old_keys = job_keys(before), keys = job_keys(now);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!is_setting(keys[i])) continue;
    std::map<std::string, std::string> old_leaves, leaves;
    flatten(keys[i].path, old_keys[i].write(), old_leaves);
    flatten(keys[i].path, keys[i].write(), leaves);
    if (old_leaves == leaves || key_of(mixed(now, i, before)) == key_of(job)) continue;
    for (const auto& [name, value] : old_leaves) leaves.try_emplace(name, "none");
    for (const auto& [name, value] : leaves) {
      const auto old = old_leaves.find(name);
      const std::string was = old == old_leaves.end() ? "none" : old->second;
      if (was != value) changes.push_back(name + " " + was + " -> " + value);
    }
  }
  return changes;
}

}  // namespace patchlight
