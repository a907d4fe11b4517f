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

bool has_ended(long process) {
  return process > 0 && ::kill(pid_t(process), 0) != 0 && errno == ESRCH;
}

/// Makes a claim where there is none.
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
    throw Error(ExitCode::cannot_create, "cannot write a frame's claim", claim.string(), "check the space left");
  return true;
}

}  // namespace

FrameClaims::FrameClaims(fs::path folder, std::chrono::milliseconds patience)
    : folder_(std::move(folder)),
      patience_(patience),
      keeper_([this](const std::stop_token& stop) { keep_alive(stop); }) {
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
      has_ended(process))
    return true;
  // After it was opened, which makes network file systems look anew.
  const fs::file_time_type touched = fs::last_write_time(claim, fault);
  if (fault) return false;
  const auto now = Clock::now();
  const auto [sight, is_new] = others_.try_emplace(claim, Sight{touched, now});
  if (sight->second.touched != touched) sight->second = {touched, now};
  return now - sight->second.since > patience_;
}

void FrameClaims::keep_alive(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (!own_.empty()) ::utimensat(AT_FDCWD, own_.c_str(), nullptr, 0);
    wake_.wait_for(lock, stop, patience_ / 6, [] { return false; });
  }
}

}  // namespace patchlight
