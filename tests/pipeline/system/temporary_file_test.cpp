#include "pipeline/system/temporary_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

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

}  // namespace
}  // namespace patchlight
