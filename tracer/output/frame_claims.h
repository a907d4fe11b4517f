#pragma once
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace patchlight {

/// Says which frame this process renders, so that others which render the same job into the same folder, on this
/// machine or another, leave it alone.
///
/// A claim is a file named by the frame's key that holds the process and its host. It is touched again and again as
/// long as the process lives. One that has not been touched for long, or whose process has gone from this host, counts
/// no more, so a killed process holds nobody up for long. Should two processes take a frame all the same, both render
/// it to the same bits. No clocks are compared.
class FrameClaims {
 public:
  /// Claims stand in `folder`, which is there; those that ended processes of this host left are removed from it.
  /// `patience`: how long a claim may stand untouched; it is touched six times in that.
  explicit FrameClaims(std::filesystem::path folder, std::chrono::milliseconds patience = std::chrono::seconds(30));
  ~FrameClaims();
  FrameClaims(const FrameClaims&) = delete;
  FrameClaims& operator=(const FrameClaims&) = delete;

  /// Claims a frame; false if another process has it. One frame at a time.
  /// Throws: Error (cannot_create).
  bool take(const std::string& frame_key);

  /// Gives up the frame that was taken.
  void release();

 private:
  using Clock = std::chrono::steady_clock;
  /// A claim of another process as it was first seen with its present time.
  struct Sight {
    std::filesystem::file_time_type touched;
    Clock::time_point since;
  };

  bool is_abandoned(const std::filesystem::path& claim);
  void keep_alive(const std::stop_token& stop);

  const std::filesystem::path folder_;
  const std::chrono::milliseconds patience_;
  std::map<std::filesystem::path, Sight> others_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::filesystem::path own_;  ///< Empty: none.
  std::jthread keeper_;
};

}  // namespace patchlight
