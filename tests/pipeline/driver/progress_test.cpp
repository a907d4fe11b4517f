#include "pipeline/stage/progress.h"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/temporary_folder.h"

namespace patchlight::test {
namespace {

TEST(Progress, LogsTheFractionAgainAfterHalfASecond) {
  const TemporaryFolder folder;
  const auto file = folder / "log.json";
  {
    Progress progress({"test", true, file.string()});
    progress.update(0.1, "too early");
    std::this_thread::sleep_for(std::chrono::milliseconds(510));
    progress.set_part(0.5, 1);
    progress.update(0.5, "half of the second part");
    progress.update(0.51, "too early again");
  }
  std::vector<nlohmann::json> lines;
  std::ifstream log(file);
  for (std::string line; std::getline(log, line);)
    if (auto read = nlohmann::json::parse(line); read["level"] == "progress") lines.push_back(std::move(read));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["message"], "half of the second part");
  EXPECT_NEAR(lines[0]["fraction"].get<double>(), 0.75, 1e-9);
}

}  // namespace
}  // namespace patchlight::test
