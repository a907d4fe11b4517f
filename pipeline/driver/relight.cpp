#include <fmt/format.h>

#include "pipeline/driver/commands.h"
#include "pipeline/driver/freshness.h"
#include "pipeline/driver/job_variants.h"
#include "pipeline/driver/output_lock.h"
#include "pipeline/driver/stage_program.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

/// Throws unless the patches are those of the job's scene as it is now.
void check_patches(const Job& job) {
  PatchSet scene;
  const Freshness patches = patches_freshness(job, scene);
  if (patches.fresh()) return;
  const bool missing = patches.state == Freshness::State::missing;
  throw Error(missing ? ExitCode::missing_input : ExitCode::bad_data,
              missing ? "there is nothing to relight yet"
                      : fmt::format("the frames are of another scene: {}", fmt::join(patches.reasons, ", ")),
              job.patch_file().string(), "`patchlight run` the job first");
}

int relight_job(const JobVariant& variant, Progress& progress) {
  const Job job = read_job(variant.job_file, variant.options.sets, variant.options.output);
  check_patches(job);
  const OutputLock lock(job, progress);
  std::vector<std::string> arguments = stage_arguments(variant.job_file, variant.options);
  arguments.insert(arguments.begin(), "--relight");
  return run_stage_program("trace", arguments).exit_code;
}

}  // namespace

int relight_jobs(const RelightCommand& command, Progress& progress) {
  Progress::catch_signals();
  int first = 0;
  for (const JobVariant& variant : job_variants(command.job_file, command.common, command.variant)) {
    if (!variant.name.empty()) progress.note("job " + variant.label());
    int code = 0;
    const int failure = report_errors("relight", progress, [&] { code = relight_job(variant, progress); });
    if (failure != 0) code = failure;
    if (first == 0) first = code;
    if (code == int(ExitCode::interrupted)) return code;
  }
  return first;
}

}  // namespace patchlight
