#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/job/reader/job_reader.h"
#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight::test {

/// Job files by their text.
class JobFile : public ::testing::Test {
 protected:
  Job read(const std::string& text, const std::vector<std::string>& sets = {}) {
    return read_job(folder_.write("job.yaml", text), sets);
  }
  TemporaryFolder folder_;
};

inline constexpr const char* kMinimal = "scene: a.glb\noutput: out\n";

}  // namespace patchlight::test
