#pragma once
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace patchlight::test {

namespace fs = std::filesystem;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

/// Exit code of a wait status; 128 + n after signal n.
inline int exit_code(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Result of a program.
struct Outcome {
  int code = -1;  ///< Exit code; 128 + n after signal n.
  std::string out;
  std::string err;
};

inline std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// Runs a program of this build in `folder`. `environment`: shell words before the command, such as `NAME=value`.
inline Outcome run_program(const TemporaryFolder& folder, const std::string& program,
                           const std::vector<std::string>& arguments, const std::string& environment = "") {
  std::string command = "cd " + quoted(folder.path().string()) + " && " + environment + " " +
                        quoted((std::filesystem::path(PATCHLIGHT_PROGRAMS) / program).string());
  for (const auto& argument : arguments) command += " " + quoted(argument);
  command += " >stdout.txt 2>stderr.txt </dev/null";
  const int status = std::system(command.c_str());
  return {exit_code(status), read_text(folder / "stdout.txt"), read_text(folder / "stderr.txt")};
}

/// Test whose programs run in a temporary folder.
class ProgramTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

/// Writes a small, fast job of configs/cornell_box.glb to `job.yaml`. `more`: further lines of YAML.
inline std::filesystem::path small_job(const TemporaryFolder& folder, const std::string& more = "") {
  std::filesystem::copy_file(std::string(PATCHLIGHT_SOURCE) + "/configs/cornell_box.glb", folder / "box.glb",
                             std::filesystem::copy_options::overwrite_existing);
  return folder.write("job.yaml",
                      "scene: box.glb\noutput: out\nimport: {patch_area: 0.01}\nsolve: {rays: 64}\n"
                      "trace: {resolution: [32, 32], samples: 4}\n" +
                          more);
}

}  // namespace patchlight::test
