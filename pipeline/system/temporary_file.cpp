#include "pipeline/system/temporary_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace fs = std::filesystem;

namespace {

/// Tells processes with the same number apart: of another boot of the machine, or in another container, where host
/// names may be the same. Random where the system does not tell, so that no file is taken for a leftover of a dead
/// process.
std::string process_space() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code fault;
  const std::string numbers = fs::read_symlink("/proc/self/ns/pid", fault).string();  // one for each container
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  KeyHasher hasher;
  hasher.add(host.data()).add(boot).add(numbers);
  static const std::int64_t unknown = std::int64_t(std::random_device()()) << 32 | std::random_device()();
  if (boot.empty() || numbers.empty()) hasher.add(unknown);
  return hasher.hex().substr(0, 16);
}

/// Names of temporaries are .patchlight-SPACE.PID.NUMBER and the target's extension.
std::string temporary_prefix() {
  return kTemporaryPrefix + process_space() + ".";
}

/// Whether a process of this process space still runs; one that has ended and waits to be reaped does not.
bool is_running(pid_t process) {
  if (::kill(process, 0) != 0 && errno == ESRCH) return false;
  std::ifstream status("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  std::getline(status, line);
  const std::size_t name_end = line.rfind(')');
  return name_end == std::string::npos || line.size() < name_end + 3 || line[name_end + 2] != 'Z';
}

void remove_leftovers(const fs::path& folder) {
  const std::string prefix = temporary_prefix();
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const long process = std::strtol(name.c_str() + prefix.size(), nullptr, 10);
    if (process <= 0 || is_running(pid_t(process))) continue;
    std::error_code ignored;
    fs::remove(entry->path(), ignored);
  }
}

bool same_file_system(const fs::path& a, const fs::path& b) {
  struct stat first, second;
  return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 && first.st_dev == second.st_dev;
}

void make_folder(const fs::path& folder) {
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault)
    throw Error(ExitCode::cannot_create, "cannot make the output folder: " + fault.message(), folder.string(),
                "choose another with --output");
}

}  // namespace

TemporaryFile::TemporaryFile(fs::path target, const fs::path& folder) : target_(std::move(target)) {
  const fs::path beside = target_.parent_path();
  make_folder(beside);
  if (!folder.empty()) make_folder(folder);
  std::error_code fault;
  if (fs::is_directory(target_, fault))
    throw Error(ExitCode::cannot_create, "cannot write the file: a folder has its name", target_.string(),
                "move the folder away");
  const fs::path& place = !folder.empty() && same_file_system(folder, beside) ? folder : beside;
  remove_leftovers(place);
  static std::atomic<int> number = 0;
  path_ = place / (temporary_prefix() + std::to_string(::getpid()) + "." + std::to_string(number++) +
                   target_.extension().string());
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

void write_text(const fs::path& file, const std::string& text) {
  TemporaryFile temporary(file);
  std::ofstream stream(temporary.path(), std::ios::binary);
  if (!stream)
    throw Error(ExitCode::cannot_create, "cannot create the file", file.string(), "check that its folder is writable");
  stream << text;
  stream.close();
  if (!stream) throw Error(ExitCode::io_error, "cannot write the file", file.string(), "check the space on the disk");
  temporary.commit();
}

}  // namespace patchlight
