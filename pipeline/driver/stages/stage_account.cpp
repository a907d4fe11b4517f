#include "pipeline/driver/stages/stage_account.h"

#include <fmt/format.h>

namespace patchlight {

bool StageAccount::needs(const std::string& stage, const StageState& state) {
  const bool damaged = state.before.state == Freshness::State::damaged || state.now.state == Freshness::State::damaged;
  if (state.now.fresh() && !command_.force) {
    const std::string explanation =
        command_.explain ? ": all that it depends on still has the key " + state.now.key : "";
    if (state.restored)
      say(damaged, stage + " restored, made before: " + reason(state.before));
    else
      progress_.note(stage + " skipped: up to date" + explanation);
    for (const std::string& warning : state.now.warnings) progress_.repeat_warning(stage, warning);
    tell({stage, state.restored ? "restored" : "fresh"});
    return false;
  }
  say(damaged, stage + (damaged ? " runs again: " : " runs: ") + reason(state.now));
  return true;
}

std::string StageAccount::reason(const Freshness& state) const {
  return state.fresh() ? "--force" : state.reason(command_.explain);
}

void StageAccount::tell(const Progress::StageResult& result) {
  progress_.result(result);
  if (!summary_) return;
  *summary_ += (summary_->empty() ? "" : ", ") + result.stage + " " +
               (result.state == "done" ? fmt::format("{:.1f} s", result.wall_seconds) : result.state);
}

}  // namespace patchlight
