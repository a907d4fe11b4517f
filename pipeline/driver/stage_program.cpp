#include "pipeline/driver/stage_program.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "pipeline/model/error.h"
#include "pipeline/stage/progress.h"

extern char** environ;

namespace patchlight {

int run_stage_program(const std::string& stage, const std::vector<std::string>& arguments) {
  const std::string program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path() / ("patchlight-" + stage)).string();
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  pid_t child = 0;
  if (const int fault = posix_spawn(&child, program.c_str(), nullptr, nullptr, argv.data(), environ))
    throw Error(ExitCode::unavailable, std::string("cannot start the stage: ") + std::strerror(fault), program,
                "build all programs into one folder");
  Progress::pass_signals_to(child);
  siginfo_t ended{};  // until it is reaped below, its number is its own
  while (waitid(P_PID, id_t(child), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  Progress::pass_signals_to(0);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  return int(signal == SIGINT || signal == SIGTERM ? ExitCode::interrupted : ExitCode::internal);
}

}  // namespace patchlight
