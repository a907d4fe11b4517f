#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// Reads a job file. Included files are read first, and the job file overrides their keys; entries of `materials` and
/// `lights` are merged. If `file` is a scene, every key has its default, and the output folder is `<scene>.patchlight`
/// beside the scene, without the scene's extension. If the scene is a Blender file, Blender exports it first, and the
/// job overrides that of the export. Relative paths are relative to the folder of the file that contains them; paths in
/// `sets` are relative to the folder of `file`. `output` replaces the job's output folder, relative to the working
/// directory; empty: no replacement. `sets`: `key.path=value` overrides; double quotes enclose a key with dots. Throws:
/// Error (missing_input) without a file; (usage) for a malformed override; (bad_config), with key and line, for broken
/// YAML, an unknown key or a bad value; (over_limit) for a frame too large.
Job read_job(const std::filesystem::path& file, const std::vector<std::string>& sets = {},
             const std::filesystem::path& output = {});

/// A job file that is read once and makes many jobs with different overrides.
class JobTemplate {
 public:
  /// Throws: the errors of read_job() about the file.
  explicit JobTemplate(const std::filesystem::path& file);

  /// The job with overrides, as from read_job(). Throws: the errors of read_job() about overrides and values.
  Job job(const std::vector<std::string>& sets, const std::filesystem::path& output) const;

  /// Removes the matrix from all further jobs, since a large one takes long to copy.
  void drop_matrix() { job_.matrix.clear(); }

 private:
  /// The job again, where its scene is a Blender file: over that of its export.
  Job job_over_export(const Job& job, const std::vector<std::string>& sets) const;

  Job job_;
  bool merges_ = false;  ///< Whether the file includes others.
};

/// The whole effective job as YAML, every default filled in; its paths relative to the job file's folder where the job
/// has them so, and absent if empty; `bench` only if it sweeps something, `slurm` only if it executes.
std::string effective_job(const Job& job);

/// Reads what effective_job() wrote. Throws: Error (bad_config).
Job parse_effective_job(const std::string& text);

/// One line for each key of a job file: name, default, meaning.
std::string job_key_help();

}  // namespace patchlight
