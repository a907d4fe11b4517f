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

/// What a stage tells its user while it runs: notes, warnings and how far it is, on stderr and in the JSON log.
/// Safe to call from the stage's main thread only. Where stderr cannot be written it goes on without.
class Progress {
 public:
  struct Options {
    std::string stage;          ///< Messages begin with `patchlight-STAGE: `.
    bool quiet = false;         ///< Only warnings and errors on stderr.
    std::string log_json_file;  ///< Empty: none.
  };

  /// Throws: Error (cannot_create) if the log file cannot be opened, or holds something else than such a log.
  explicit Progress(Options options);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void note(const std::string& message);
  void warning(const std::string& message);
  /// About this run, not about its output: warnings() leaves it out.
  void transient_warning(const std::string& message);
  void error(const std::string& message, int exit_code);

  /// All that warning() was given so far.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Wall time since this began, s.
  double seconds() const;

  /// Reports how much of a part of the stage is done, clamped to [0,1], in the user's words what part, and how many
  /// rays it took so far, if that is known. A smaller fraction than the last begins another part. Cheap: call it often.
  /// Throws: Error (interrupted) after SIGINT or SIGTERM.
  void update(double fraction, const std::string& detail, std::int64_t rays = 0);

  /// Further lines of the JSON log name this job and where its output goes.
  void set_job(const std::string& job, const std::string& output);

  /// How a stage of a job came out, for the JSON log alone.
  struct StageResult {
    std::string stage;
    std::string state;  ///< fresh, restored, done or failed.
    int exit_code = 0;
    double wall_seconds = 0, cpu_seconds = 0;
    std::int64_t peak_bytes = 0;
  };
  void result(const StageResult& result);

  /// Tells what another program told in its JSON log, in that program's name: notes, warnings and errors.
  void pass_on(const nlohmann::json& line);

  /// Gives a warning again that `stage` gave when it made an output that is still up to date. The JSON log marks it
  /// with `"repeated": true`.
  void repeat_warning(const std::string& stage, const std::string& message);

  /// From now on update() is about part `part` of `count` alike.
  void set_part(std::size_t part, std::size_t count);

  /// Throws: Error (interrupted) after SIGINT or SIGTERM.
  static void check_interrupted();

  /// From now on SIGINT and SIGTERM only ask the stage to stop.
  static void catch_signals();

  /// From now on passes them on to a process as well, and at once what came before; 0: to none.
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
  double part_ = 0, parts_ = 1;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_shown_{};
  Clock::time_point part_start_ = start_, last_update_ = start_;
  double last_fraction_ = 0.0;
  std::string job_, output_;
  std::vector<std::string> warnings_;
  bool terminal_ = false;
  bool line_open_ = false;
};

}  // namespace patchlight
