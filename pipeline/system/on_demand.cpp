#include "pipeline/system/on_demand.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

#include "pipeline/model/error.h"

namespace patchlight {

void* on_demand(const char* module, const char* symbol) {
  std::error_code fault;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", fault);
  const auto file = program.parent_path().parent_path() / "lib" / (std::string(module) + ".so");
  void* const library = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const found = library ? ::dlsym(library, symbol) : nullptr;
  if (!found)
    throw Error(ExitCode::internal, std::string("cannot load a library: ") + ::dlerror(), file, "build again");
  return found;
}

}  // namespace patchlight
