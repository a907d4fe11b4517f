#include "pipeline/driver/output_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "pipeline/model/error.h"

namespace patchlight {

OutputLock::OutputLock(const Job& job, Progress& progress) {
  std::error_code fault;
  std::filesystem::create_directories(job.output, fault);
  folder_ = ::open(job.output.c_str(), O_RDONLY | O_DIRECTORY);  // which started programs inherit
  if (folder_ < 0)
    throw Error(ExitCode::cannot_create, "cannot make the output folder", job.output.string(),
                "choose another with --output");
  if (::flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;  // some file systems have no locks
  progress.note("waits for another run in " + job.output.string());
  while (::flock(folder_, LOCK_EX) != 0 && errno == EINTR) Progress::check_interrupted();
}

OutputLock::~OutputLock() {
  ::close(folder_);
}

}  // namespace patchlight
