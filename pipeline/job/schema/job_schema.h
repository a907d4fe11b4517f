#pragma once
#include <yaml-cpp/yaml.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// One key of a job file, bound to its place in a Job. The only list of keys: reading, help and the effective job are
/// made from it.
struct JobKey {
  using Read = std::function<void(const YAML::Node&)>;

  std::string path;  ///< `section.name`, or a name alone.
  std::string help;
  Read read;                          ///< Throws: std::string, which values are allowed; EntryFault.
  std::function<YAML::Node()> write;  ///< The present value.
  Read read_some{};                   ///< Of a map of names: reads some settings and leaves the others as they are.
};

/// What is wrong below a key that is a map of names, and where.
struct EntryFault {
  std::string what;
  std::string mend;
  YAML::Mark mark;
};

std::vector<JobKey> job_keys(Job& job);

/// Refuses a setting, in the notation of `--set`, that a job would not take. Throws: EntryFault, at `mark`.
void check_setting(const std::string& key, const YAML::Node& value, const YAML::Mark& mark);

/// A value on one line, as an override takes it.
std::string flow_text(const YAML::Node& value);

// The list's parts that stand in files of their own.

/// The key `materials` or `nodes`.
JobKey overrides_key(const std::string& section, std::vector<MaterialOverride>& overrides, const std::string& help);

/// Those of the section `environment`.
std::vector<JobKey> environment_keys(EnvironmentConfig& sky);

/// The key `lights`.
JobKey lights_key(std::map<std::string, LightSetting>& lights);

/// Those of the section `trace`.
std::vector<JobKey> trace_keys(TraceConfig& trace);

/// The key `matrix`.
JobKey matrix_key(std::vector<MatrixAxis>& matrix);

/// Those of the section `slurm`.
std::vector<JobKey> slurm_keys(SlurmConfig& slurm);

/// Those of the section `bench`, which job_keys() ends with.
std::vector<JobKey> bench_keys(BenchConfig& bench);

}  // namespace patchlight
