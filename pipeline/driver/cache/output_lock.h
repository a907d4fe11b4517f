#pragma once
#include <string>

#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Holds an output folder, which it makes: for tracing, which several runs may do at once, or for one run that makes
/// the solution, which others wait for. The stages that a run starts hold it too: if the run is killed, the next waits
/// for its last stage and then finds what that made. Where a file system has no locks it does nothing.
class OutputLock {
 public:
  /// For tracing. Throws: Error (cannot_create), (interrupted) while it waits.
  OutputLock(const Job& job, Progress& progress);
  ~OutputLock();

  /// What stood before the change may be another's by now. Throws: Error (interrupted) while it waits.
  void for_one();
  void for_tracing();

  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  void hold(int kind);

  Progress& progress_;
  std::string name_;
  int folder_ = -1;
};

}  // namespace patchlight
