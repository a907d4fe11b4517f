#pragma once
#include <chrono>
#include <cstdint>
#include <fstream>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace spdlog {
class logger;
}

namespace patchlight {

/// Messages of a stage to its user: notes, warnings, errors and progress, on stderr and in the JSON log. For the main
/// thread only. Failures to write to stderr are ignored.
class Progress {
 public:
  struct Options {
    std::string stage;          ///< Messages begin with `patchlight-STAGE: `.
    bool quiet = false;         ///< Only warnings and errors on stderr.
    std::string log_json_file;  ///< Empty: none.
  };

  /// Throws: Error (cannot_create) if the log file cannot be opened or is not a log of Patchlight.
  explicit Progress(Options options);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void note(const std::string& message);
  void warning(const std::string& message);
  /// A warning about this run, not about its output: it is not in warnings().
  void transient_warning(const std::string& message);
  void error(const std::string& message, int exit_code);

  /// All messages of warning() so far.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Wall time since construction, s.
  double seconds() const;

  /// Reports progress, and the time left of the whole. `fraction`: of the present part, clamped to [0,1]; where the
  /// whole's becomes smaller, another whole begins. `detail`: name of the part, for the user. `rays`: cast so far in
  /// this part; 0: unknown. Cheap.
  /// Throws: Error (interrupted) after SIGINT or SIGTERM.
  void update(double fraction, const std::string& detail, std::int64_t rays = 0);

  /// Adds job and output folder to the following lines of the JSON log.
  void set_job(const std::string& job, const std::string& output);

  /// Result of a stage, for the JSON log only.
  struct StageResult {
    std::string stage;
    std::string state;  ///< fresh, restored, done or failed.
    int exit_code = 0;
    double wall_seconds = 0, cpu_seconds = 0;
    std::int64_t peak_bytes = 0;
  };
  void result(const StageResult& result);

  /// Forwards a line of another program's JSON log, under its name: notes, warnings and errors.
  void pass_on(const nlohmann::json& line);

  /// Repeats a warning that `stage` gave when it wrote an output that is still fresh. The JSON log marks it with
  /// `"repeated": true`.
  void repeat_warning(const std::string& stage, const std::string& message);

  /// update() now reports the part of the whole from `begin` to `end`, in [0,1].
  void set_part(double begin, double end);
  /// The same for part `part` of `count` equal parts.
  void set_part(std::size_t part, std::size_t count);

  /// Throws: Error (interrupted) after SIGINT or SIGTERM.
  static void check_interrupted();

  /// SIGINT and SIGTERM now only request the stage to stop.
  static void catch_signals();

  /// Forwards SIGINT and SIGTERM to a process as well, also one received before; 0: to none.
  static void pass_signals_to(int process);

 private:
  using Clock = std::chrono::steady_clock;

  void write_json(const char* level, const std::string& message, int exit_code = -1, double fraction = -1,
                  double rays_per_second = 0);
  nlohmann::json json_line(const char* level, const std::string& message) const;
  void write_line(const nlohmann::json& line);
  void open_json_log();
  void clear_line();

  Options options_;
  std::shared_ptr<spdlog::logger> terminal_log_;
  std::ofstream json_file_;
  std::shared_ptr<spdlog::logger> json_log_;  ///< Null: none.
  bool json_failed_ = false;
  double part_begin_ = 0, part_end_ = 1;  ///< Over the whole.
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_shown_{}, last_logged_{};
  Clock::time_point whole_start_ = start_, part_start_ = start_, last_update_ = start_;
  double start_fraction_ = 0.0;  ///< Of the whole, at whole_start_.
  double last_fraction_ = 0.0;
  std::string job_, output_;
  std::vector<std::string> warnings_;
  bool terminal_ = false;
  bool line_open_ = false;
};

}  // namespace patchlight
