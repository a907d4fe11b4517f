#include "pipeline/driver/stages/stage_program.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "pipeline/system/child_process.h"

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

double seconds(const timeval& time) {
  return double(time.tv_sec) + 1e-6 * double(time.tv_usec);
}

}  // namespace

ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = start_program(program, arguments, nullptr, "build all programs into one folder");
  Progress::pass_signals_to(child);
  rusage usage{};
  std::int64_t peak = 0;
  const int status = wait_for(child, usage, peak);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {exit_code_of(status), seconds(usage.ru_utime) + seconds(usage.ru_stime), wall.count(), peak};
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
