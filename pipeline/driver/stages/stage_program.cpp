#include "pipeline/driver/stages/stage_program.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "pipeline/model/error.h"

extern char** environ;

namespace patchlight {

namespace {

/// Largest resident set of a running process so far, bytes; 0 once it has ended.
std::int64_t peak_so_far(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::atoll(line.c_str() + 6) * 1024;
  return 0;
}

/// Waits for a child. The peak that the kernel reports includes the parent's memory at the fork; if that may exceed the
/// child's own, the peak polled while it ran is used.
int wait_for(pid_t child, rusage& usage, std::int64_t& peak) {
  rusage own{};
  getrusage(RUSAGE_SELF, &own);
  pollfd ended{int(syscall(SYS_pidfd_open, child, 0)), POLLIN, 0};
  constexpr int kInterval = 5;  // ms
  while (ended.fd >= 0 && poll(&ended, 1, kInterval) <= 0) peak = std::max(peak, peak_so_far(child));
  close(ended.fd);
  siginfo_t gone{};  // its process id is not reused until it is reaped below
  while (waitid(P_PID, id_t(child), &gone, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  Progress::pass_signals_to(0);
  int status = 0;
  while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  if (usage.ru_maxrss > own.ru_maxrss || peak == 0) peak = std::int64_t(usage.ru_maxrss) * 1024;
  return status;
}

int exit_code_of(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  return int(signal == SIGINT || signal == SIGTERM ? ExitCode::interrupted : ExitCode::internal);
}

double seconds(const timeval& time) {
  return double(time.tv_sec) + 1e-6 * double(time.tv_usec);
}

/// Throws: Error (unavailable), with `mend`.
pid_t spawn(const std::string& program, const std::vector<std::string>& arguments,
            const posix_spawn_file_actions_t* files, const std::string& mend) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  if (const int fault = posix_spawnp(&child, program.c_str(), files, nullptr, argv.data(), environ))
    throw Error(ExitCode::unavailable, std::string("cannot start the program: ") + std::strerror(fault), program, mend);
  return child;
}

std::string all_of(std::FILE* stream) {
  std::string text;
  std::rewind(stream);
  for (std::array<char, 4096> part; const std::size_t count = std::fread(part.data(), 1, part.size(), stream);)
    text.append(part.data(), count);
  return text;
}

}  // namespace

ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = spawn(program, arguments, nullptr, "build all programs into one folder");
  Progress::pass_signals_to(child);
  rusage usage{};
  std::int64_t peak = 0;
  const int status = wait_for(child, usage, peak);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {exit_code_of(status), seconds(usage.ru_utime) + seconds(usage.ru_stime), wall.count(), peak};
}

ProgramOutput capture_program(const std::string& program, const std::vector<std::string>& arguments,
                              const std::string& mend) {
  using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  const Stream out(std::tmpfile(), std::fclose), err(std::tmpfile(), std::fclose);
  if (!out || !err) throw Error(ExitCode::cannot_create, "cannot make a temporary file", program, "is /tmp full?");
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const std::unique_ptr<posix_spawn_file_actions_t, int (*)(posix_spawn_file_actions_t*)> owner(
      &files, posix_spawn_file_actions_destroy);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, fileno(err.get()), STDERR_FILENO);
  const pid_t child = spawn(program, arguments, &files, mend);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return {exit_code_of(status), all_of(out.get()), all_of(err.get())};
}

std::vector<std::string> stage_arguments(const std::string& job_file, const CommonOptions& options) {
  std::vector<std::string> arguments;
  const auto add = [&](const std::string& option, const std::string& value) {
    if (!value.empty()) arguments.push_back(option + "=" + value);
  };
  for (const auto& set : options.sets) add("--set", set);
  add("--output", options.output);
  add("--threads", options.threads > 0 ? std::to_string(options.threads) : "");
  add("--memory", options.memory > 0 ? std::to_string(options.memory) : "");
  add("--log-json", options.log_json);
  if (options.quiet) arguments.push_back("--quiet");
  arguments.insert(arguments.end(), {"--", job_file});
  return arguments;
}

std::string stage_program(const std::string& stage) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / ("patchlight-" + stage)).string();
}

ProgramRun run_stage_program(const std::string& stage, const std::vector<std::string>& arguments) {
  return run_program(stage_program(stage), arguments);
}

}  // namespace patchlight
