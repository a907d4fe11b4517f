#include "pipeline/system/on_demand.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

#include "pipeline/model/error.h"

namespace patchlight {

void* on_demand(const char* module, const char* symbol) {
  std::error_code fault;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", fault);
  const auto file = program.parent_path().parent_path() / "lib/patchlight" / (std::string(module) + ".so");
  if (!std::filesystem::exists(file, fault))
    throw Error(ExitCode::internal, "a module of " + program.filename().string() + " is missing", file,
                "keep bin/ and lib/ together when you move Patchlight, or install it again");
  void* const library = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const found = library ? ::dlsym(library, symbol) : nullptr;
  if (!found)
    throw Error(ExitCode::internal, std::string("cannot load a module: ") + ::dlerror(), file,
                "install the libraries that it needs, or install Patchlight again");
  return found;
}

}  // namespace patchlight
