#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct RunCommand {
  std::string job_file;
  bool force = false;
  CommonOptions common;
};

/// Starts the stages whose outputs do not match the job, in order, and says why. Returns the exit code of the first
/// stage that fails, else 0.
int run_job(const RunCommand& command, Progress& progress);

struct InfoCommand {
  std::string file;
};

/// Prints what is in a file. Returns an exit code. Throws: Error (missing_input, bad_data).
int show_info(const InfoCommand& command);

struct DiffCommand {
  std::string a;
  std::string b;
  std::optional<double> tolerance;  ///< Absent: none, or any beside `max`.
  std::optional<double> max;
};

/// Prints how two files of one kind differ. Returns 1 if by more than is allowed, else 0.
/// Throws: Error (missing_input, bad_data).
int compare_files(const DiffCommand& command);

}  // namespace patchlight
