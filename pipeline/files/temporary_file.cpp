#include "pipeline/files/temporary_file.h"

#include <unistd.h>

#include "pipeline/model/error.h"

namespace patchlight {

namespace fs = std::filesystem;

TemporaryFile::TemporaryFile(fs::path target) : target_(std::move(target)) {
  std::error_code fault;
  fs::create_directories(target_.parent_path(), fault);
  if (fault)
    throw Error(ExitCode::cannot_create, "cannot make the output folder: " + fault.message(),
                target_.parent_path().string(), "choose another with --output");
  if (fs::is_directory(target_, fault))
    throw Error(ExitCode::cannot_create, "cannot write the file: a folder has its name", target_.string(),
                "move the folder away");
  path_ = target_.parent_path() /
          ("." + target_.stem().string() + "." + std::to_string(::getpid()) + target_.extension().string());
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void TemporaryFile::commit() {
  std::error_code fault;
  fs::rename(path_, target_, fault);
  if (fault)
    throw Error(ExitCode::io_error, "cannot replace the file: " + fault.message(), target_.string(),
                "check that the folder is writable");
}

}  // namespace patchlight
