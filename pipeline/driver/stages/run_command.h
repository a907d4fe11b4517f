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
  bool explain = false;                               ///< Print all reasons, also for skipped stages.
  std::filesystem::path cache{};                      ///< Cache folder; empty: in the job's output.
  std::shared_ptr<const JobTemplate> job_template{};  ///< The read job file; null: read it.
};

}  // namespace patchlight
