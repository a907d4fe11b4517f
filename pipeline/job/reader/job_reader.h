#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// Whether a file's name is that of a scene, not of a job: .glb, .gltf or .blend, in letters of either case.
bool is_scene_file(const std::filesystem::path& file);

/// Reads a job file and those that it includes, whose keys it overrides; entries of `materials` and `lights` are
/// merged. A scene may stand for a job: all settings are the defaults, and the output folder is `<scene>.patchlight`
/// beside the scene, without the scene's extension. Relative paths become relative to the folder of the file that they
/// stand in, those of `sets` to the folder of `file`. `output`, unless empty, replaces the job's, relative to the
/// working directory. `sets` are `key.path=value` overrides; a key that holds dots stands in double quotes.
/// Throws: Error (missing_input) without a file; (usage) for a malformed override;
/// (bad_config), with key and line, for broken YAML, an unknown key or a value that is not allowed; (over_limit) for
/// frames too large.
Job read_job(const std::filesystem::path& file, const std::vector<std::string>& sets = {},
             const std::filesystem::path& output = {});

/// A job file that is read once, for many jobs that differ in overrides.
class JobTemplate {
 public:
  /// Throws: what read_job throws of the file.
  explicit JobTemplate(const std::filesystem::path& file);

  /// What read_job returns. Throws: what read_job throws.
  Job job(const std::vector<std::string>& sets, const std::filesystem::path& output) const;

  /// From now on jobs lack the matrix of the file, which takes time to copy where it has many choices.
  void drop_matrix() { job_.matrix.clear(); }

 private:
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
