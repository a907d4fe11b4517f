#include "pipeline/driver/commands.h"
#include "pipeline/driver/freshness.h"
#include "pipeline/driver/stage_program.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

int run_job(const RunCommand& command, Progress& progress) {
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  const std::vector<std::string> arguments = stage_arguments(command.job_file, command.common);

  /// Runs the stage unless its output is fresh. Returns its exit code.
  const auto bring_up_to_date = [&](const std::string& stage, const Freshness& state) {
    if (state.fresh && !command.force) {
      progress.note(stage + " skipped: up to date");
      return 0;
    }
    if (state.damaged)
      progress.warning(stage + " runs again: " + state.reason);
    else
      progress.note(stage + " runs: " + (state.fresh ? "--force" : state.reason));
    return run_stage_program(stage, arguments).exit_code;
  };

  PatchSet scene;
  if (const int code = bring_up_to_date("import", patches_freshness(job, scene))) return code;
  scene = read_patches(job.patch_file());
  std::string energy_key;
  if (const int code = bring_up_to_date("solve", energy_freshness(job, scene, energy_key))) return code;
  energy_freshness(job, scene, energy_key);
  return bring_up_to_date("trace", frames_freshness(job, scene, energy_key));
}

}  // namespace patchlight
