#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct ReportCommand {
  std::string job_file;
  std::string variant;  ///< Glob; empty: all.
  CommonOptions common;
};

/// Updates stale stages, then writes <output>/report.html, one self-contained page. Returns an exit code.
/// Throws: Error (bad_config, missing_input) for the job, (cannot_create, io_error, interrupted).
int write_report_page(const ReportCommand& command, Progress& progress);

}  // namespace patchlight
