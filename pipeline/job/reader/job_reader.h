#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// Reads a job file and those that it includes, whose keys it overrides; entries of `materials` and `lights` are
/// merged. Relative paths become relative to the folder of the file that they stand in. `output`, unless empty,
/// replaces the job's, relative to the working directory. `sets` are `key.path=value` overrides; a key that holds dots
/// stands in double quotes. Throws: Error (missing_input) without a file; (usage) for a malformed override;
/// (bad_config), with key and line, for broken YAML, an unknown key or a value that is not allowed; (over_limit) for
/// frames too large.
Job read_job(const std::filesystem::path& file, const std::vector<std::string>& sets = {},
             const std::filesystem::path& output = {});

/// The whole effective job as YAML, every default filled in; its paths relative to the job file's folder where the job
/// has them so, and absent if empty; `bench` only if it sweeps something, `slurm` only if it executes.
std::string effective_job(const Job& job);

/// Reads what effective_job() wrote. Throws: Error (bad_config).
Job parse_effective_job(const std::string& text);

/// One line for each key of a job file: name, default, meaning.
std::string job_key_help();

}  // namespace patchlight
