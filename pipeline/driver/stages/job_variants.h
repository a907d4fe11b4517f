#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/stage/stage.h"

namespace patchlight {

/// One job to run: a job file with overrides.
struct JobVariant {
  std::string job_file;
  std::string name;       ///< Its choices, joined by commas; empty for a job without a matrix.
  CommonOptions options;  ///< Those of the command line, over the variant's own settings, with its output folder.
  std::string cache;      ///< The folder that all variants of the job share for outputs of earlier settings.

  std::shared_ptr<const JobTemplate> job_template{};  ///< All variants share it.

  /// Its job, without a matrix. Throws: what read_job throws.
  Job job() const { return job_template->job(options.sets, options.output); }
  std::string label() const { return name.empty() ? job_file : job_file + " " + name; }
};

/// The variants of a job's matrix, the last axis running fastest, each with a folder of its own in the job's output;
/// or the job itself. `pattern`: a glob that names must match; empty: all.
/// Throws: what read_job throws; Error (bad_config) if no name matches.
std::vector<JobVariant> job_variants(const std::string& job_file, const CommonOptions& options,
                                     const std::string& pattern = "");

}  // namespace patchlight
