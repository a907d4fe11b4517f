#include "pipeline/driver/commands/relight.h"

#include <fmt/format.h>

#include "pipeline/driver/cache/freshness.h"
#include "pipeline/driver/cache/output_lock.h"
#include "pipeline/driver/stages/job_variants.h"
#include "pipeline/driver/stages/stage_program.h"
#include "pipeline/frames/light_settings.h"
#include "pipeline/job/view_config.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

/// Throws unless patches.h5 is fresh.
PatchSet fresh_patches(const Job& job) {
  PatchSet scene;
  const Freshness patches = patches_freshness(job, scene);
  if (patches.fresh()) return scene;
  const bool missing = patches.state == Freshness::State::missing;
  throw Error(missing ? ExitCode::missing_input : ExitCode::bad_data,
              missing ? "there is nothing to relight yet"
                      : fmt::format("the frames are of another scene: {}", fmt::join(patches.reasons, ", ")),
              job.patch_file().string(), "`patchlight run` the job first");
}

int relight_job(const RelightCommand& command, const JobVariant& variant, Progress& progress) {
  const Job job = variant.job();
  const PatchSet scene = fresh_patches(job);
  check_names(job, scene);
  const OutputLock lock(job, progress);
  const std::string view_config = view_config_key(job.trace.picture.ocio);
  JointFreshness frames;
  for (const Frame& frame : job_frames(job, scene))
    frames.add(frame.exr.filename().string(), relit_freshness(job, scene, frame, view_config));
  const Freshness state = frames.all();
  if (state.fresh() && !command.force) {
    progress.note("relight skipped: up to date");
    progress.result({"relight", "fresh"});
    return 0;
  }
  progress.note("relight runs: " + (state.fresh() ? "--force" : state.reason(command.explain)));
  std::vector<std::string> arguments = stage_arguments(variant.job_file, variant.options);
  if (!command.force) arguments.insert(arguments.begin(), "--skip-fresh");
  arguments.insert(arguments.begin(), "--relight");
  const ProgramRun run = run_stage_program("trace", arguments);
  progress.result({"relight", run.exit_code == 0 ? "done" : "failed", run.exit_code, run.wall_seconds, run.cpu_seconds,
                   run.peak_bytes});
  return run.exit_code;
}

}  // namespace

int relight_jobs(const RelightCommand& command, Progress& progress) {
  Progress::catch_signals();
  int first = 0;
  for (const JobVariant& variant : job_variants(command.job_file, command.common, command.variant)) {
    progress.set_job(variant.job_file, variant.options.output);
    if (!variant.name.empty()) progress.note("job " + variant.label());
    int code = 0;
    const int failure = report_errors("relight", progress, [&] { code = relight_job(command, variant, progress); });
    if (failure != 0) code = failure;
    if (first == 0) first = code;
    if (code == int(ExitCode::interrupted)) return code;
  }
  return first;
}

}  // namespace patchlight
