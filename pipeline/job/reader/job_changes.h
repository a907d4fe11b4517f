#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// `job` with all settings, scene and output apart, as in the effective job `made_for`, or as they are if that cannot
/// be read.
Job with_settings_of(const Job& job, const std::string& made_for);

/// Those settings in which `job` differs from the effective job that an output was made for and for which `key_of`
/// gives another key than for `job`, each as `solve.rays 64 -> 256`. None if `made_for` cannot be read.
std::vector<std::string> changed_settings(const Job& job, const std::string& made_for,
                                          const std::function<std::string(const Job&)>& key_of);

}  // namespace patchlight
