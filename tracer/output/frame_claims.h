#pragma once
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace patchlight {

/// Lock files that divide the frames of one job among processes, on this machine or others, that write to one folder.
///
/// A claim is a file named by the frame's key. It holds the process id and the host name, and its owner updates its
/// modification time at regular intervals. A claim is void if its process has ended on this host or if its modification
/// time stands still for `timeout`, so a killed process delays the others only briefly. If two processes claim one
/// frame by accident, both render it to the same bits. Clocks of different hosts are never compared.
class FrameClaims {
 public:
  /// Removes claims of ended processes of this host from `folder`, which must exist.
  /// `timeout`: age at which a claim becomes void; its owner updates it six times in this period.
  explicit FrameClaims(std::filesystem::path folder, std::chrono::milliseconds timeout = std::chrono::seconds(30));
  ~FrameClaims();
  FrameClaims(const FrameClaims&) = delete;
  FrameClaims& operator=(const FrameClaims&) = delete;

  /// Claims a frame; false if another process holds it. One frame at a time.
  /// Throws: Error (cannot_create).
  bool take(const std::string& frame_key);

  /// Gives up the claimed frame.
  void release();

 private:
  using Clock = std::chrono::steady_clock;
  /// When this process first saw the present modification time of another process's claim.
  struct Observation {
    std::filesystem::file_time_type modified;
    Clock::time_point since;
  };

  bool is_abandoned(const std::filesystem::path& claim);
  void keep_alive(const std::stop_token& stop);

  const std::filesystem::path folder_;
  const std::chrono::milliseconds timeout_;
  std::map<std::filesystem::path, Observation> others_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::filesystem::path own_;  ///< Empty: none.
  std::jthread heartbeat_;
};

}  // namespace patchlight
