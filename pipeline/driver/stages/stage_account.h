#pragma once
#include <string>

#include "pipeline/driver/stages/run_command.h"
#include "pipeline/driver/stages/stage_state.h"

namespace patchlight {

/// Says which stages of a job run and why, and what became of them.
class StageAccount {
 public:
  /// `summary`, unless null: is told what each stage did, in a few words.
  StageAccount(const RunCommand& command, Progress& progress, std::string* summary)
      : command_(command), progress_(progress), summary_(summary) {}

  /// Whether a stage has to run; says why or why not.
  bool needs(const std::string& stage, const StageState& state);

  void tell(const Progress::StageResult& result);

 private:
  void say(bool warn, const std::string& message) { warn ? progress_.warning(message) : progress_.note(message); }
  std::string reason(const Freshness& state) const;

  const RunCommand& command_;
  Progress& progress_;
  std::string* summary_;
};

}  // namespace patchlight
