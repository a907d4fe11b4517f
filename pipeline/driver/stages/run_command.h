#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/stage/stage.h"

namespace patchlight {

struct RunCommand {
  std::string job_file;
  bool force = false;
  CommonOptions common;
  std::string last_stage = "trace";
  bool explain = false;           ///< Say all reasons, also those not to run.
  std::filesystem::path cache{};  ///< Where outputs of earlier settings are kept; empty: in the job's own output.
  std::shared_ptr<const JobTemplate> job_template{};  ///< Of the job file; null: it is read.
};

}  // namespace patchlight
