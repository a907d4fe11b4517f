#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

/// How a program ended and what the whole process took.
struct ProgramRun {
  int exit_code = 0;       ///< 75 if SIGINT or SIGTERM killed it, 70 after any other signal.
  double cpu_seconds = 0;  ///< User and system.
  double wall_seconds = 0;
  std::int64_t peak_bytes = 0;  ///< Largest resident set.
};

/// Runs a program, looked up in $PATH unless it is a path, and waits for it. SIGINT and SIGTERM are passed on to it
/// once Progress catches them.
/// Throws: Error (unavailable) if it cannot be started.
ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments);

/// What a program wrote and how it ended.
struct ProgramOutput {
  int exit_code = 0;  ///< As in ProgramRun.
  std::string out, err;
};

/// Runs a program that ends soon, without input, and waits for it. Throws: Error (unavailable) if it cannot be started,
/// with `mend`, how to mend that.
ProgramOutput capture_program(const std::string& program, const std::vector<std::string>& arguments,
                              const std::string& mend);

/// The command line that hands a job and these options on to a stage.
std::vector<std::string> stage_arguments(const std::string& job_file, const CommonOptions& options);

/// Where `patchlight-STAGE` stands: in this program's own folder.
std::string stage_program(const std::string& stage);

/// Runs `patchlight-STAGE` of this program's own folder. Throws: as run_program.
ProgramRun run_stage_program(const std::string& stage, const std::vector<std::string>& arguments);

}  // namespace patchlight
