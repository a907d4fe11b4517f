#include "pipeline/driver/commands/run.h"

#include "pipeline/driver/cache/freshness.h"
#include "pipeline/driver/cache/output_cache.h"
#include "pipeline/driver/cache/output_lock.h"
#include "pipeline/driver/slurm/slurm_run.h"
#include "pipeline/driver/stages/stage_account.h"
#include "pipeline/driver/stages/stage_program.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/frames/light_settings.h"
#include "pipeline/job/job_check.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr int kMaxRounds = 20;  // of interference by other runs

/// Updates a job's stages one after another.
class JobRun {
 public:
  JobRun(const RunCommand& command, StageAccount& account) : command_(command), account_(account) {}

  /// Runs the stage unless its output is fresh. Returns its exit code.
  int bring_up_to_date(const std::string& stage, const StageState& state) {
    Progress::check_interrupted();
    if (!account_.needs(stage, state)) return 0;
    std::vector<std::string> arguments = stage_arguments(command_.job_file, command_.common);
    if (stage == "trace" && !command_.force) arguments.insert(arguments.begin(), "--skip-fresh");
    const ProgramRun run = run_stage_program(stage, arguments);
    account_.tell({stage, run.exit_code == 0 ? "done" : "failed", run.exit_code, run.wall_seconds, run.cpu_seconds,
                   run.peak_bytes});
    if (run.exit_code == 0) Progress::check_interrupted();  // a stage that was ending may not have seen the signal
    return run.exit_code;
  }

 private:
  const RunCommand& command_;
  StageAccount& account_;
};

/// Updates the solution. Returns the exit code of the failed stage, else 0.
int make_solution(const RunCommand& command, const Job& job, const OutputCache& cache, JobRun& run, PatchSet& scene) {
  const auto import = [&] { return patches_freshness(job, scene); };
  if (const int code = run.bring_up_to_date(
          "import", stage_state(import, [&] { return !command.force && cache.restore_patches(job); })))
    return code;
  scene = read_patches(job.patch_file());
  cache.keep_patches(job, scene);
  check_names(job, scene);
  if (command.last_stage == "import") return 0;

  const auto solve = [&] { return energy_freshness(job, scene); };
  if (const int code = run.bring_up_to_date(
          "solve", stage_state(solve, [&] { return !command.force && cache.restore_energy(job, scene); })))
    return code;
  cache.keep_energy(job, scene);
  return 0;
}

}  // namespace

int run_job(const RunCommand& command, Progress& progress, std::string* summary) {
  Progress::catch_signals();
  const Job job = command.job_template ? command.job_template->job(command.common.sets, command.common.output)
                                       : read_job(command.job_file, command.common.sets, command.common.output);
  check_available(job.solve);
  const OutputCache cache(command.cache.empty() ? cache_folder(job) : command.cache, job.cache);
  StageAccount account(command, progress, summary);
  OutputLock lock(job, progress);
  if (job.executor == "slurm") {
    lock.for_one();
    run_on_slurm(command, job, cache, account, progress);
    return 0;
  }

  JobRun run(command, account);
  PatchSet scene;
  const auto is_fresh = [&] {
    return patches_freshness(job, scene).fresh() &&
           (command.last_stage == "import" || energy_freshness(job, scene).fresh());
  };
  bool fresh = !command.force && is_fresh();
  int rounds = 0;
  do {
    if (rounds++ == kMaxRounds)
      throw Error(ExitCode::internal, "the stages do not make what the job asks for, however often they run",
                  job.output.string(), "build all programs from one version; run jobs with other settings elsewhere");
    if (!fresh) lock.for_one();
    if (const int code = make_solution(command, job, cache, run, scene)) return code;
    if (command.last_stage != "trace") return 0;
    lock.for_tracing();
  } while (!fresh && !(fresh = is_fresh()));  // a run with other settings may interfere

  if (const int code = run.bring_up_to_date("trace", frames_state(job, scene, command.force ? nullptr : &cache)))
    return code;
  keep_frames(job, scene, cache);
  cache.trim();
  return 0;
}

}  // namespace patchlight
