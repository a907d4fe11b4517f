#pragma once
#include <spawn.h>
#include <sys/types.h>

#include <string>
#include <vector>

namespace patchlight {

/// Starts a program, looked up in $PATH unless it is a path. `files`: null, or what is done to its open files.
/// Throws: Error (unavailable), with the remedy `mend`, if it cannot be started.
pid_t start_program(const std::string& program, const std::vector<std::string>& arguments,
                    const posix_spawn_file_actions_t* files, const std::string& mend);

/// The exit code of a process's status: 75 if SIGINT or SIGTERM killed it, 70 after any other signal.
int exit_code_of(int status);

/// Output and exit code of a program.
struct ProgramOutput {
  int exit_code = 0;  ///< As from exit_code_of().
  std::string out, err;
};

/// Runs a program without input and waits for it. A signal that this program handles ends the other one. Throws: Error
/// (unavailable), with the remedy `mend`, if it cannot be started.
ProgramOutput capture_program(const std::string& program, const std::vector<std::string>& arguments,
                              const std::string& mend);

}  // namespace patchlight
