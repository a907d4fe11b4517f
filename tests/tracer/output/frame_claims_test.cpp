#include "tracer/output/frame_claims.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using std::chrono::milliseconds;

std::size_t files_in(const std::filesystem::path& folder) {
  return std::size_t(std::distance(std::filesystem::directory_iterator(folder), {}));
}

class FrameClaim : public ::testing::Test {
 protected:
  /// Writes a claim that nobody keeps alive.
  void write_claim(const std::string& key, const std::string& process, const std::string& host) {
    folder_.write(".patchlight-claim-" + key, process + " " + host + "\n");
  }

  static std::string this_host() {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    return host.data();
  }

  test::TemporaryFolder folder_;
};

TEST_F(FrameClaim, IsHeldByOneAtATime) {
  FrameClaims first(folder_.path()), second(folder_.path());
  EXPECT_TRUE(first.take("a"));
  EXPECT_FALSE(second.take("a"));
  EXPECT_TRUE(second.take("b"));
  first.release();
  second.release();
  EXPECT_TRUE(second.take("a"));
  EXPECT_FALSE(first.take("a"));
}

TEST_F(FrameClaim, LeavesNothingBehind) {
  {
    FrameClaims claims(folder_.path());
    EXPECT_TRUE(claims.take("a"));
    EXPECT_EQ(files_in(folder_.path()), 1u);
  }
  EXPECT_EQ(files_in(folder_.path()), 0u);
}

TEST_F(FrameClaim, OfAKilledProcessIsVoid) {
  FrameClaims claims(folder_.path());
  const pid_t child = fork();
  if (child == 0) {
    FrameClaims killed(folder_.path());
    killed.take("a");
    killed.release();
    killed.take("b");
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  ASSERT_EQ(files_in(folder_.path()), 1u);
  EXPECT_TRUE(claims.take("b"));
}

TEST_F(FrameClaim, OfAnExitedProcessIsRemoved) {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  write_claim("a", std::to_string(child), this_host());
  const FrameClaims claims(folder_.path());
  EXPECT_EQ(files_in(folder_.path()), 0u);
}

TEST_F(FrameClaim, OfAnotherHostHoldsUntilItTimesOut) {
  write_claim("a", "1", "elsewhere.example");
  FrameClaims claims(folder_.path(), milliseconds(200));
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(claims.take("a"));
    std::this_thread::sleep_for(milliseconds(100));
    std::filesystem::last_write_time(folder_ / ".patchlight-claim-a", std::filesystem::file_time_type::clock::now());
  }
  EXPECT_FALSE(claims.take("a"));
  std::this_thread::sleep_for(milliseconds(250));
  EXPECT_TRUE(claims.take("a"));
}

TEST_F(FrameClaim, IsKeptAlive) {
  FrameClaims claims(folder_.path(), milliseconds(300));
  ASSERT_TRUE(claims.take("a"));
  const auto modified = [&] { return std::filesystem::last_write_time(folder_ / ".patchlight-claim-a"); };
  for (int i = 0; i < 3; ++i) {
    const auto before = modified();
    for (int k = 0; k < 2000 && modified() == before; ++k) std::this_thread::sleep_for(milliseconds(10));
    EXPECT_GT(modified(), before);
  }
}

TEST_F(FrameClaim, ThatIsStillEmptyHolds) {
  folder_.write(".patchlight-claim-a", "");
  FrameClaims claims(folder_.path());
  EXPECT_FALSE(claims.take("a"));
}

TEST_F(FrameClaim, InAMissingFolderIsRefused) {
  FrameClaims claims(folder_ / "nowhere");
  EXPECT_ERROR(claims.take("a"), ExitCode::cannot_create, "nowhere");
}

}  // namespace
}  // namespace patchlight
