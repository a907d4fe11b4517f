#include "pipeline/driver/commands/status.h"

#include <fmt/format.h>

#include "pipeline/driver/cache/freshness.h"
#include "pipeline/driver/stages/job_variants.h"
#include "pipeline/frames/light_settings.h"
#include "pipeline/job/job_check.h"
#include "pipeline/job/view_config.h"
#include "pipeline/system/standard_streams.h"

namespace patchlight {

namespace {

void print_line(const char* stage, const std::string& state, const std::string& file, const std::string& reason) {
  print(fmt::format("{:<8}{:<9}{}{}{}\n", stage, state, file, reason.empty() ? "" : "  ", reason));
}

/// Prints the line of one output. Returns whether it is fresh.
bool report(const char* stage, const std::string& file, const Freshness& freshness) {
  std::string reason = fmt::format("{}", fmt::join(freshness.reasons, ", "));
  if (freshness.state == Freshness::State::missing && !reason.starts_with("its "))
    reason.clear();  // it would repeat the state
  print_line(stage, freshness.name(), file, reason);
  return freshness.fresh();
}

/// Returns whether all outputs of `patchlight run` are fresh; relit frames do not count.
bool report_job(const JobVariant& variant) {
  const Job job = variant.job();
  check_available(job.solve);
  PatchSet scene;
  if (!report("import", "patches.h5", patches_freshness(job, scene))) {
    print_line("solve", "unknown", "energy.h5", "until import has run");
    print_line("trace", "unknown", "frames", "until import has run");
    return false;
  }
  check_names(job, scene);
  bool fresh = report("solve", "energy.h5", energy_freshness(job, scene));
  const std::string view_config = view_config_key(job.trace.picture.ocio);
  for (const Frame& frame : job_frames(job, scene))
    fresh &=
        report("trace", "frames/" + frame.exr.filename().string(), frame_freshness(job, scene, frame, view_config));
  if (std::error_code fault; std::filesystem::exists(job.relit_folder(), fault))  // otherwise `relight` never ran
    for (const Frame& frame : job_frames(job, scene))
      report("relight", "relit/" + frame.exr.filename().string(), relit_freshness(job, scene, frame, view_config));
  return fresh;
}

}  // namespace

int show_status(const StatusCommand& command) {
  bool fresh = true;
  for (const std::string& job_file : command.job_files) {
    const std::vector<JobVariant> variants = job_variants(job_file, command.common, command.variant);
    for (const JobVariant& variant : variants) {
      if (command.job_files.size() + variants.size() > 2) print(fmt::format("{}\n", variant.label()));
      fresh &= report_job(variant);
    }
  }
  return fresh ? 0 : 1;
}

}  // namespace patchlight
