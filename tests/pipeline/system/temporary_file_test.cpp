#include "pipeline/system/temporary_file.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

TEST(TemporaryFile, StandsInTheFolderItIsGiven) {
  const test::TemporaryFolder folder;
  TemporaryFile file(folder / "frames/a.exr", folder.path());
  EXPECT_EQ(file.path().parent_path(), folder.path());
  EXPECT_EQ(file.path().extension(), ".exr");
  std::ofstream(file.path()) << "whole";
  file.commit();
  EXPECT_EQ(test::read_text(folder / "frames/a.exr"), "whole");
}

TEST(TemporaryFile, RemovesWhatKilledProcessesLeft) {
  const test::TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    const TemporaryFile killed(folder / "a.h5");
    std::ofstream(killed.path()) << "half";
    _exit(0);  // without destructors
  }
  siginfo_t info;
  ASSERT_EQ(waitid(P_PID, id_t(child), &info, WEXITED | WNOWAIT), 0);  // it has ended, and waits to be reaped
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  const TemporaryFile alive(folder / "b.h5");
  std::ofstream(alive.path()) << "half";
  const TemporaryFile other(folder / "c.h5");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_TRUE(std::filesystem::exists(alive.path()));
  waitpid(child, nullptr, 0);
}

// In a namespace of process numbers as a container has, under the same host name.
TEST(TemporaryFile, LeavesFilesOfOtherContainersAlone) {
  const test::TemporaryFolder folder;
  pid_t free_number = 20;
  while (kill(free_number, 0) == 0 || errno != ESRCH) ++free_number;
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t container = fork();
  if (container == 0) {
    if (unshare(CLONE_NEWPID) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWPID) != 0) _exit(1);
    const pid_t first = fork();
    if (first > 0) {
      int status = 0;
      waitpid(first, &status, 0);
      _exit(0);
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (pid_t child = 0; (child = fork()) != 0;) waitpid(child, nullptr, 0);  // until one has the number
    if (getpid() != free_number) _exit(0);
    const TemporaryFile file(folder / "theirs.h5");
    std::ofstream(file.path()) << "half";
    if (write(ready[1], "x", 1) == 1) pause();
  }
  close(ready[1]);
  char byte = 0;
  if (read(ready[0], &byte, 1) == 1) {
    const TemporaryFile ours(folder / "ours.h5");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "of process " << free_number;
  }
  close(ready[0]);
  kill(container, SIGKILL);
  waitpid(container, nullptr, 0);
  if (byte == 0) GTEST_SKIP() << "needs the right to make namespaces";
}

}  // namespace
}  // namespace patchlight
