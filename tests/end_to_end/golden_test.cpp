#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"

namespace patchlight {
namespace {

using test::Outcome;
using test::run_program;
using test::TemporaryFolder;

// What each stage made of the golden job, kept in golden/. `golden/regenerate` makes them anew after a wanted change.
const std::string kGolden = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/";

/// Runs one stage from the golden output of the one before and compares its own.
class Golden : public ::testing::Test {
 protected:
  void expect_same(const std::string& stage, const std::vector<std::string>& inputs, const std::string& golden,
                   const std::string& output, const std::string& tolerance) {
    std::filesystem::create_directories(folder_ / "out");
    for (const auto& input : inputs) std::filesystem::copy_file(kGolden + input, folder_ / ("out/" + input));
    const Outcome outcome =
        run_program(folder_, "patchlight-" + stage, {kGolden + "job.yaml", "--output", (folder_ / "out").string()});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Outcome diff =
        run_program(folder_, "patchlight", {"diff", kGolden + golden, "out/" + output, "--tolerance", tolerance});
    EXPECT_EQ(diff.code, 0) << diff.out << diff.err;
  }
  TemporaryFolder folder_;
};

TEST_F(Golden, PatchesAreAsTheyWere) {
  expect_same("import", {}, "patches.h5", "patches.h5", "1e-6");
}

// A processor of another kind may send single rays to the other side of an edge.
TEST_F(Golden, EnergyIsAsItWas) {
  expect_same("solve", {"patches.h5"}, "energy.h5", "energy.h5", "2e-3");
}

TEST_F(Golden, FrameIsAsItWas) {
  expect_same("trace", {"patches.h5", "energy.h5"}, "frame.exr", "frames/camera.0001.exr", "2e-3");
}

}  // namespace
}  // namespace patchlight
