#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "pipeline/driver/commands.h"
#include "pipeline/driver/freshness.h"
#include "pipeline/files/job_check.h"

namespace patchlight {

namespace {

void print_line(const char* stage, const std::string& state, const std::string& file, const std::string& reason) {
  fmt::print("{:<8}{:<9}{}{}{}\n", stage, state, file, reason.empty() ? "" : "  ", reason);
}

/// Prints a line on one output. Returns whether it is fresh.
bool report(const char* stage, const std::string& file, const Freshness& freshness) {
  static constexpr std::array<const char*, 4> kNames{"fresh", "stale", "missing", "damaged"};
  std::string reason = fmt::format("{}", fmt::join(freshness.reasons, ", "));
  if (freshness.state == Freshness::State::missing && !reason.starts_with("its ")) reason.clear();  // it says no more
  print_line(stage, kNames[std::size_t(freshness.state)], file, reason);
  return freshness.fresh();
}

}  // namespace

int show_status(const StatusCommand& command) {
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  check_available(job.solve);
  PatchSet scene;
  if (!report("import", "patches.h5", patches_freshness(job, scene))) {
    print_line("solve", "unknown", "energy.h5", "until import has run");
    print_line("trace", "unknown", "frames", "until import has run");
    return 1;
  }
  check_names(job, scene);
  bool fresh = report("solve", "energy.h5", energy_freshness(job, scene));
  for (const Frame& frame : job_frames(job, scene))
    fresh &= report("trace", "frames/" + frame.exr.filename().string(), frame_freshness(job, scene, frame));
  return fresh ? 0 : 1;
}

}  // namespace patchlight
