#pragma once
#include <yaml-cpp/yaml.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// One key of a job file, bound to a member of a Job. Reading, help and the effective job all use this list of keys.
struct JobKey {
  using Read = std::function<void(const YAML::Node&)>;

  std::string path;  ///< `section.name`, or a name alone.
  std::string help;
  Read read;                          ///< Throws: std::string, the allowed values; EntryFault.
  std::function<YAML::Node()> write;  ///< The current value.
  Read read_some{};                   ///< Of a map of names: reads some settings without changing others.
};

/// A fault below a key that is a map of names, and its location.
struct EntryFault {
  std::string what;
  std::string mend;
  YAML::Mark mark;
};

std::vector<JobKey> job_keys(Job& job);

/// Checks a setting in the notation of `--set`. Throws: EntryFault, at `mark`, if a job does not accept it.
void check_setting(const std::string& key, const YAML::Node& value, const YAML::Mark& mark);

/// A value on one line, in the notation of overrides.
std::string flow_text(const YAML::Node& value);

// Parts of the list that are defined in separate files.

/// The key `materials` or `nodes`.
JobKey overrides_key(const std::string& section, std::vector<MaterialOverride>& overrides, const std::string& help);

/// Keys of the section `environment`.
std::vector<JobKey> environment_keys(EnvironmentConfig& sky);

/// The key `lights`.
JobKey lights_key(std::map<std::string, LightSetting>& lights);

/// Keys of the section `trace`.
std::vector<JobKey> trace_keys(TraceConfig& trace);

/// The key `matrix`.
JobKey matrix_key(std::vector<MatrixAxis>& matrix);

/// Keys of the section `slurm`.
std::vector<JobKey> slurm_keys(SlurmConfig& slurm);

/// Keys of the section `bench`, the last ones of job_keys().
std::vector<JobKey> bench_keys(BenchConfig& bench);

}  // namespace patchlight
