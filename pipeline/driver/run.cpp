#include "pipeline/driver/commands.h"
#include "pipeline/driver/freshness.h"
#include "pipeline/driver/stage_program.h"
#include "pipeline/files/job_check.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

int run_job(const RunCommand& command, Progress& progress) {
  Progress::catch_signals();
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  check_available(job.solve);
  const std::vector<std::string> arguments = stage_arguments(command.job_file, command.common);

  /// Runs the stage unless its output is fresh. Returns its exit code.
  const auto bring_up_to_date = [&](const std::string& stage, const Freshness& state) {
    Progress::check_interrupted();
    if (state.fresh && !command.force) {
      progress.note(stage + " skipped: up to date");
      return 0;
    }
    if (state.damaged)
      progress.warning(stage + " runs again: " + state.reason);
    else
      progress.note(stage + " runs: " + (state.fresh ? "--force" : state.reason));
    std::vector<std::string> all = arguments;
    if (stage == "trace" && !command.force) all.insert(all.begin(), "--skip-fresh");
    const int code = run_stage_program(stage, all).exit_code;
    if (code == 0) Progress::check_interrupted();  // a stage that was just ending does not tell
    return code;
  };

  PatchSet scene;
  if (const int code = bring_up_to_date("import", patches_freshness(job, scene))) return code;
  scene = read_patches(job.patch_file());
  check_names(job, scene);
  if (command.last_stage == "import") return 0;
  if (const int code = bring_up_to_date("solve", energy_freshness(job, scene))) return code;
  if (command.last_stage == "solve") return 0;
  return bring_up_to_date("trace", frames_freshness(job, scene));
}

}  // namespace patchlight
