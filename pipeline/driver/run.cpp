#include <fmt/format.h>

#include "pipeline/driver/commands.h"
#include "pipeline/driver/freshness.h"
#include "pipeline/driver/output_cache.h"
#include "pipeline/driver/output_lock.h"
#include "pipeline/driver/stage_program.h"
#include "pipeline/files/job_check.h"
#include "pipeline/files/key.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr int kMostRounds = 20;  // as often as other runs may come between

/// A stage's output as it is, and as it was before what was made earlier with the same settings was put back.
struct StageState {
  Freshness now;
  Freshness before;
  bool restored = false;
};

StageState frames_state(const Job& job, const PatchSet& scene, const OutputCache* cache) {
  JointFreshness before, now;
  bool restored = false;
  for (const Frame& frame : job_frames(job, scene)) {
    const std::string name = frame.exr.filename().string();
    Freshness one = frame_freshness(job, scene, frame);
    before.add(name, one);
    if (!one.fresh() && cache && cache->restore_frame(frame, one.key)) {
      one = frame_freshness(job, scene, frame);
      restored |= one.fresh();
    }
    now.add(name, one);
  }
  return {now.all(), before.all(), restored};
}

/// Where `freshness` says that the output is not fresh, tries to `restore` it.
template <class FreshnessOf, class Restore>
StageState stage_state(FreshnessOf freshness, Restore restore) {
  const Freshness before = freshness();
  if (before.fresh() || !restore()) return {before, before, false};
  const Freshness now = freshness();
  return {now, before, now.fresh()};
}

/// Keeps all frames of a job under their keys.
void keep_frames(const Job& job, const PatchSet& scene, const OutputCache& cache) {
  const std::string energy = energy_key(scene.key, job.solve), view_config = view_config_key();
  for (const Frame& frame : job_frames(job, scene))
    cache.keep_frame(frame, frame_key(scene, energy, job, frame.camera, frame.number, view_config));
}

/// Brings a job's stages up to date one after another.
class JobRun {
 public:
  JobRun(const RunCommand& command, Progress& progress, std::string* account)
      : command_(command), progress_(progress), account_(account) {}

  /// Runs the stage unless its output is fresh. Returns its exit code.
  int bring_up_to_date(const std::string& stage, const StageState& state) {
    Progress::check_interrupted();
    const bool damaged =
        state.before.state == Freshness::State::damaged || state.now.state == Freshness::State::damaged;
    if (state.now.fresh() && !command_.force) {
      if (state.restored)
        say(damaged, stage + " restored, made before: " + reason(state.before));
      else
        progress_.note(stage + " skipped: up to date" + explanation(state.now));
      tell({stage, state.restored ? "restored" : "fresh"});
      return 0;
    }
    say(damaged, stage + (damaged ? " runs again: " : " runs: ") + reason(state.now));
    std::vector<std::string> arguments = stage_arguments(command_.job_file, command_.common);
    if (stage == "trace" && !command_.force) arguments.insert(arguments.begin(), "--skip-fresh");
    const ProgramRun run = run_stage_program(stage, arguments);
    tell({stage, run.exit_code == 0 ? "done" : "failed", run.exit_code, run.wall_seconds, run.cpu_seconds,
          run.peak_bytes});
    if (run.exit_code == 0) Progress::check_interrupted();  // a stage that was just ending does not tell
    return run.exit_code;
  }

 private:
  void say(bool warn, const std::string& message) { warn ? progress_.warning(message) : progress_.note(message); }

  std::string explanation(const Freshness& state) const {
    return command_.explain ? ": all that it depends on still has the key " + state.key : "";
  }

  std::string reason(const Freshness& state) const {
    return state.fresh() ? "--force" : state.reason(command_.explain);
  }

  void tell(const Progress::StageResult& result) {
    progress_.result(result);
    if (!account_) return;
    *account_ += (account_->empty() ? "" : ", ") + result.stage + " " +
                 (result.state == "done" ? fmt::format("{:.1f} s", result.wall_seconds) : result.state);
  }

  const RunCommand& command_;
  Progress& progress_;
  std::string* account_;
};

/// Brings the solution up to date. Returns the exit code of the stage that fails, else 0.
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

int run_job(const RunCommand& command, Progress& progress, std::string* account) {
  Progress::catch_signals();
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  check_available(job.solve);
  const OutputCache cache(command.cache.empty() ? cache_folder(job) : command.cache, job.cache);
  JobRun run(command, progress, account);
  OutputLock lock(job, progress);

  PatchSet scene;
  const auto is_fresh = [&] {
    return patches_freshness(job, scene).fresh() &&
           (command.last_stage == "import" || energy_freshness(job, scene).fresh());
  };
  bool fresh = !command.force && is_fresh();
  int rounds = 0;
  do {
    if (rounds++ == kMostRounds)
      throw Error(ExitCode::internal, "the stages do not make what the job asks for, however often they run",
                  job.output.string(), "build all programs from one version; run jobs with other settings elsewhere");
    if (!fresh) lock.for_one();
    if (const int code = make_solution(command, job, cache, run, scene)) return code;
    if (command.last_stage != "trace") return 0;
    lock.for_tracing();
  } while (!fresh && !(fresh = is_fresh()));  // else a run with other settings came between

  if (const int code = run.bring_up_to_date("trace", frames_state(job, scene, command.force ? nullptr : &cache)))
    return code;
  keep_frames(job, scene, cache);
  cache.trim();
  return 0;
}

}  // namespace patchlight
