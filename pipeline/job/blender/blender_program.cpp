#include "pipeline/job/blender/blender_program.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

bool is_program(const fs::path& file) {
  std::error_code fault;
  return fs::is_regular_file(file, fault) && ::access(file.c_str(), X_OK) == 0;
}

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

/// Folders in which an archive from blender.org may be unpacked, newest version first.
std::vector<fs::path> unpacked_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code fault, ignored;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault))
    if (entry->path().filename().string().starts_with("blender") && entry->is_directory(ignored))
      found.push_back(entry->path());
  std::sort(found.rbegin(), found.rend());
  return found;
}

}  // namespace

fs::path blender_program() {
  if (const fs::path named = variable("BLENDER"); !named.empty()) {
    if (is_program(named)) return named;
    throw Error(ExitCode::unavailable, "$BLENDER is not a program", named, "set it to Blender's program, or unset it");
  }
  std::istringstream folders(variable("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');)
    if (fs::path program = fs::path(folder) / "blender"; is_program(program)) return program;
  std::vector<fs::path> usual{"/usr/bin", "/usr/local/bin", "/snap/bin", "/var/lib/flatpak/exports/bin",
                              "/Applications/Blender.app/Contents/MacOS"};
  for (const fs::path& folder : {fs::path("/opt"), fs::path(variable("HOME"))})
    if (!folder.empty())
      for (fs::path& unpacked : unpacked_in(folder)) usual.push_back(std::move(unpacked));
  for (const fs::path& folder : usual)
    for (const char* const name : {"blender", "org.blender.Blender", "Blender"})
      if (fs::path program = folder / name; is_program(program)) return program;
  throw Error(ExitCode::unavailable, "there is no Blender to read a .blend file with", "",
              "install Blender 3.4 or newer, or set $BLENDER to its program");
}

fs::path blender_exporter() {
  std::error_code fault;
  const fs::path program = fs::read_symlink("/proc/self/exe", fault);
  fs::path folder = program.parent_path().parent_path() / "share/patchlight/blender";
  if (!fs::exists(folder / "export.py", fault))
    throw Error(ExitCode::internal, "the exporter for Blender is missing", folder,
                "keep bin/ and share/ together when you move Patchlight, or install it again");
  return folder;
}

}  // namespace patchlight
