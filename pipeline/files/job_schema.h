#pragma once
#include <yaml-cpp/yaml.h>

#include <functional>
#include <string>
#include <vector>

#include "pipeline/files/job.h"

namespace patchlight {

/// One key of a job file, bound to its place in a Job. The only list of keys: reading, help and the effective job are
/// made from it.
struct JobKey {
  std::string path;  ///< `section.name`, or a name alone.
  std::string help;
  std::function<void(const YAML::Node&)> read;  ///< Throws: std::string, what is wrong and which values are allowed.
  std::function<YAML::Node()> write;            ///< The present value.
};

std::vector<JobKey> job_keys(Job& job);

/// Those of the section `bench`, which job_keys() ends with.
std::vector<JobKey> bench_keys(BenchConfig& bench);

}  // namespace patchlight
