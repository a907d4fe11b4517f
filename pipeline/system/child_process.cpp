#include "pipeline/system/child_process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>

#include "pipeline/model/error.h"

extern char** environ;

namespace patchlight {

namespace {

std::string all_of(std::FILE* stream) {
  std::string text;
  std::rewind(stream);
  for (std::array<char, 4096> part; const std::size_t count = std::fread(part.data(), 1, part.size(), stream);)
    text.append(part.data(), count);
  return text;
}

}  // namespace

pid_t start_program(const std::string& program, const std::vector<std::string>& arguments,
                    const posix_spawn_file_actions_t* files, const std::string& mend) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  if (const int fault = posix_spawnp(&child, program.c_str(), files, nullptr, argv.data(), environ))
    throw Error(ExitCode::unavailable, std::string("cannot start the program: ") + std::strerror(fault), program, mend);
  return child;
}

int exit_code_of(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  return int(signal == SIGINT || signal == SIGTERM ? ExitCode::interrupted : ExitCode::internal);
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
  const pid_t child = start_program(program, arguments, &files, mend);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) ::kill(child, SIGTERM);
  return {exit_code_of(status), all_of(out.get()), all_of(err.get())};
}

}  // namespace patchlight
