#include "tracer/output/frame_claims.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include "pipeline/model/error.h"

namespace patchlight {

namespace fs = std::filesystem;

namespace {

constexpr const char* kPrefix = ".patchlight-claim-";

std::string host_name() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  return host.data();
}

bool has_exited(long process) {
  return process > 0 && ::kill(pid_t(process), 0) != 0 && errno == ESRCH;
}

/// Creates a claim file; false if it exists.
bool create(const fs::path& claim) {
  const int file = ::open(claim.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) {
    if (errno == EEXIST) return false;
    throw Error(ExitCode::cannot_create, fmt::format("cannot claim a frame: {}", std::strerror(errno)), claim.string(),
                "check that its folder is writable");
  }
  const std::string text = fmt::format("{} {}\n", ::getpid(), host_name());
  const bool written = ::write(file, text.data(), text.size()) == ssize_t(text.size());
  ::close(file);
  if (!written)
    throw Error(ExitCode::cannot_create, "cannot write a frame's claim", claim.string(), "check the free disk space");
  return true;
}

}  // namespace

FrameClaims::FrameClaims(fs::path folder, std::chrono::milliseconds timeout)
    : folder_(std::move(folder)),
      timeout_(timeout),
      heartbeat_([this](const std::stop_token& stop) { keep_alive(stop); }) {
  std::error_code fault;
  for (fs::directory_iterator entry(folder_, fault), end; !fault && entry != end; entry.increment(fault)) {
    if (!entry->path().filename().string().starts_with(kPrefix) || !is_abandoned(entry->path())) continue;
    std::error_code ignored;
    fs::remove(entry->path(), ignored);
  }
}

FrameClaims::~FrameClaims() {
  release();
}

bool FrameClaims::take(const std::string& frame_key) {
  const fs::path claim = folder_ / (kPrefix + frame_key);
  std::error_code ignored;
  if (is_abandoned(claim)) fs::remove(claim, ignored);
  if (!create(claim)) return false;
  others_.erase(claim);
  const std::lock_guard lock(mutex_);
  own_ = claim;
  return true;
}

void FrameClaims::release() {
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  if (!own_.empty()) fs::remove(own_, ignored);
  own_.clear();
}

bool FrameClaims::is_abandoned(const fs::path& claim) {
  std::error_code fault;
  long process = 0;
  std::string host;
  if (fs::is_regular_file(claim, fault) && std::ifstream(claim) >> process >> host && host == host_name() &&
      has_exited(process))
    return true;
  // Opening the file above makes network file systems refresh its attributes.
  const fs::file_time_type modified = fs::last_write_time(claim, fault);
  if (fault) return false;
  const auto now = Clock::now();
  const auto [observation, is_new] = others_.try_emplace(claim, Observation{modified, now});
  if (observation->second.modified != modified) observation->second = {modified, now};
  return now - observation->second.since > timeout_;
}

void FrameClaims::keep_alive(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (!own_.empty()) ::utimensat(AT_FDCWD, own_.c_str(), nullptr, 0);
    wake_.wait_for(lock, stop, timeout_ / 6, [] { return false; });
  }
}

}  // namespace patchlight
