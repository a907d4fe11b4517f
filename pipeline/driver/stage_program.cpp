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

namespace {

volatile std::sig_atomic_t running_child = 0;

extern "C" void pass_on(int signal) {
  if (running_child > 0) kill(pid_t(running_child), signal);
}

}  // namespace

std::vector<std::string> stage_arguments(const std::string& job_file, const CommonOptions& options) {
  std::vector<std::string> arguments;
  const auto add = [&](const std::string& option, const std::string& value) {
    if (!value.empty()) arguments.insert(arguments.end(), {option, value});
  };
  for (const auto& set : options.sets) add("--set", set);
  add("--output", options.output);
  add("--threads", options.threads > 0 ? std::to_string(options.threads) : "");
  add("--log-json", options.log_json);
  if (options.quiet) arguments.push_back("--quiet");
  arguments.insert(arguments.begin(), job_file);
  return arguments;
}

int run_stage_program(const std::string& stage, const std::vector<std::string>& arguments) {
  const std::string program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path() / ("patchlight-" + stage)).string();
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  struct sigaction action {
  }, old_int, old_term;
  action.sa_handler = pass_on;
  sigaction(SIGINT, &action, &old_int);
  sigaction(SIGTERM, &action, &old_term);
  pid_t child = 0;
  if (const int fault = posix_spawn(&child, program.c_str(), nullptr, nullptr, argv.data(), environ))
    throw Error(ExitCode::unavailable, std::string("cannot start the stage: ") + std::strerror(fault), program,
                "build all programs into one folder");
  running_child = child;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  running_child = 0;
  sigaction(SIGINT, &old_int, nullptr);
  sigaction(SIGTERM, &old_term, nullptr);
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  return int(signal == SIGINT || signal == SIGTERM ? ExitCode::interrupted : ExitCode::internal);
}

}  // namespace patchlight
