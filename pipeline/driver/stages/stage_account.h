#pragma once
#include <string>

#include "pipeline/driver/stages/run_command.h"
#include "pipeline/driver/stages/stage_state.h"

namespace patchlight {

/// Reports which stages of a job run, why, and with which result.
class StageAccount {
 public:
  /// `summary`: receives a short text on each stage; may be null.
  StageAccount(const RunCommand& command, Progress& progress, std::string* summary)
      : command_(command), progress_(progress), summary_(summary) {}

  /// Whether a stage has to run; prints the reason.
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
