#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

/// Exit code and resource use of a process.
struct ProgramRun {
  int exit_code = 0;       ///< As from exit_code_of().
  double cpu_seconds = 0;  ///< User and system.
  double wall_seconds = 0;
  std::int64_t peak_bytes = 0;  ///< Largest resident set.
};

/// Runs a program, looked up in $PATH unless it is a path, and waits for it. SIGINT and SIGTERM are passed on to it
/// once Progress catches them.
/// Throws: Error (unavailable) if it cannot be started.
ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments);

/// The arguments that pass a job and these options to a stage program.
std::vector<std::string> stage_arguments(const std::string& job_file, const CommonOptions& options);

/// Path of `patchlight-STAGE`, beside this program.
std::string stage_program(const std::string& stage);

/// Runs `patchlight-STAGE`. Throws: errors of run_program().
ProgramRun run_stage_program(const std::string& stage, const std::vector<std::string>& arguments);

}  // namespace patchlight
