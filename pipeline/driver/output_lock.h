#pragma once
#include "pipeline/files/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Holds an output folder, which it makes, for one run at a time; others wait. The stages that a run starts hold it
/// too: if the run is killed, the next waits for its last stage and then finds what that made.
class OutputLock {
 public:
  /// Throws: Error (cannot_create), (interrupted) while it waits.
  OutputLock(const Job& job, Progress& progress);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  int folder_ = -1;
};

}  // namespace patchlight
