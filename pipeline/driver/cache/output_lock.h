#pragma once
#include <string>

#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Locks an output folder, which it creates: shared for tracing, exclusive for import and solve. The stages that a run
/// starts inherit the lock: after a killed run, the next run waits for its last stage. On file systems without locks it
/// does nothing.
class OutputLock {
 public:
  /// Takes the shared lock. Throws: Error (cannot_create); (interrupted) while waiting.
  OutputLock(const Job& job, Progress& progress);
  ~OutputLock();

  /// Change the lock to exclusive or shared. Another run may have changed the outputs meanwhile.
  /// Throws: Error (interrupted) while waiting.
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
