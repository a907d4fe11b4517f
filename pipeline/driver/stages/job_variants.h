#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/stage/stage.h"

namespace patchlight {

/// One variant of a job: a job file with overrides.
struct JobVariant {
  std::string job_file;
  std::string name;       ///< Its choices, joined by commas; empty for a job without a matrix.
  CommonOptions options;  ///< Options of the command line, with the variant's settings and output folder.
  std::string cache;      ///< Cache folder shared by all variants of the job.

  std::shared_ptr<const JobTemplate> job_template{};  ///< Shared by all variants.

  /// The job of this variant, without a matrix. Throws: errors of read_job().
  Job job() const { return job_template->job(options.sets, options.output); }
  std::string label() const { return name.empty() ? job_file : job_file + " " + name; }
};

/// The variants of a job's matrix, the last axis fastest, each with its own folder in the job's output; without a
/// matrix, the job itself. `pattern`: glob that names must match; empty: all. Throws: errors of read_job(); Error
/// (bad_config) if no name matches.
std::vector<JobVariant> job_variants(const std::string& job_file, const CommonOptions& options,
                                     const std::string& pattern = "");

}  // namespace patchlight
