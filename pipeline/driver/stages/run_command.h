#pragma once
#include <filesystem>
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct RunCommand {
  std::string job_file;
  bool force = false;
  CommonOptions common;
  std::string last_stage = "trace";
  bool explain = false;           ///< Say all reasons, also those not to run.
  std::filesystem::path cache{};  ///< Where outputs of earlier settings are kept; empty: in the job's own output.
};

}  // namespace patchlight
