#include "pipeline/driver/cache/output_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "pipeline/model/error.h"

namespace patchlight {

OutputLock::OutputLock(const Job& job, Progress& progress) : progress_(progress), name_(job.output.string()) {
  std::error_code fault;
  std::filesystem::create_directories(job.output, fault);
  folder_ = ::open(job.output.c_str(), O_RDONLY | O_DIRECTORY);  // inherited by started programs
  if (folder_ < 0)
    throw Error(ExitCode::cannot_create, "cannot make the output folder", name_, "choose another with --output");
  for_tracing();
}

OutputLock::~OutputLock() {
  ::close(folder_);
}

void OutputLock::for_one() {
  hold(LOCK_EX);
}

void OutputLock::for_tracing() {
  hold(LOCK_SH);
}

void OutputLock::hold(int kind) {
  if (::flock(folder_, kind | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  progress_.note("waits for another run in " + name_);
  while (::flock(folder_, kind) != 0 && errno == EINTR) Progress::check_interrupted();
}

}  // namespace patchlight
