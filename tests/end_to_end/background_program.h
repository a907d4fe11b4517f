#pragma once
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/end_to_end/program.h"

extern char** environ;

namespace patchlight::test {

/// Starts a program as the leader of a new process group and appends its stderr to `log`.
inline pid_t start_program(const std::string& program, const std::vector<std::string>& arguments, const fs::path& log) {
  std::vector<std::string> words{(fs::path(PATCHLIGHT_PROGRAMS) / program).string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawnattr_t group;
  posix_spawnattr_init(&group);
  posix_spawnattr_setflags(&group, POSIX_SPAWN_SETPGROUP);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, log.c_str(), O_CREAT | O_APPEND | O_WRONLY, 0600);
  pid_t child = 0;
  EXPECT_EQ(posix_spawn(&child, argv[0], &files, &group, argv.data(), environ), 0);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&group);
  return child;
}

/// Waits for a program to end and returns its exit code.
inline int wait_for(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return exit_code(status);
}

}  // namespace patchlight::test
