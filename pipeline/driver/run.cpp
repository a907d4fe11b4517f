#include <fmt/format.h>

#include "pipeline/driver/commands.h"
#include "pipeline/driver/freshness.h"
#include "pipeline/driver/stage_program.h"
#include "pipeline/files/job_check.h"
#include "pipeline/files/key.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

/// Of all frames together; frames with the same reasons in one line.
Freshness frames_freshness(const Job& job, const PatchSet& scene) {
  using State = Freshness::State;
  Freshness all;
  KeyHasher key;
  std::vector<std::pair<std::string, std::vector<std::string>>> names;  // by reason
  for (const Frame& frame : job_frames(job, scene)) {
    const Freshness one = frame_freshness(job, scene, frame);
    key.add(one.key);
    if (one.fresh()) continue;
    if (all.state != State::damaged) all.state = one.state == State::damaged ? State::damaged : State::stale;
    const std::string reason = fmt::format("{}", fmt::join(one.reasons, ", "));
    if (names.empty() || names.back().first != reason) names.push_back({reason, {}});
    names.back().second.push_back(frame.exr.filename().string());
  }
  for (const auto& [reason, files] : names)
    all.reasons.push_back(
        fmt::format("{}{}: {}", files.front(), files.size() > 1 ? fmt::format(" to {}", files.back()) : "", reason));
  all.key = key.hex();
  return all;
}

}  // namespace

int run_job(const RunCommand& command, Progress& progress) {
  Progress::catch_signals();
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  check_available(job.solve);
  const std::vector<std::string> arguments = stage_arguments(command.job_file, command.common);

  /// Runs the stage unless its output is fresh. Returns its exit code.
  const auto bring_up_to_date = [&](const std::string& stage, const Freshness& state) {
    Progress::check_interrupted();
    const std::string explanation = ": all that it depends on still has the key " + state.key;
    if (state.fresh() && !command.force) {
      progress.note(stage + " skipped: up to date" + (command.explain ? explanation : ""));
      return 0;
    }
    std::string reason = state.fresh() ? "--force" : state.reasons.front();
    if (state.reasons.size() > 1 && !command.explain)
      reason += fmt::format(", and {} more (--explain lists them)", state.reasons.size() - 1);
    else if (state.reasons.size() > 1)
      reason = fmt::format("{}", fmt::join(state.reasons, "; "));
    if (state.state == Freshness::State::damaged)
      progress.warning(stage + " runs again: " + reason);
    else
      progress.note(stage + " runs: " + reason);
    const int code = run_stage_program(stage, arguments).exit_code;
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
