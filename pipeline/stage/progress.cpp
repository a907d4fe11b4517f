#include "pipeline/stage/progress.h"

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "pipeline/model/error.h"
#include "pipeline/system/standard_streams.h"

namespace patchlight {

namespace {

// Seconds between two lines of progress.
constexpr double kTerminalInterval = 0.1, kFileInterval = 5.0, kLogInterval = 0.5;

volatile std::sig_atomic_t stop_requested = 0;  ///< Number of the received signal.
volatile std::sig_atomic_t informed_process = 0;

extern "C" void request_stop(int signal) {
  stop_requested = signal;
  if (informed_process > 0) kill(pid_t(informed_process), signal);
}

double in_seconds(std::chrono::steady_clock::duration span) {
  return std::chrono::duration<double>(span).count();
}

std::string duration_text(double s) {
  if (s < 60) return fmt::format("{:.0f} s", s);
  return fmt::format("{:.0f} min {:02.0f} s", std::floor(s / 60), std::fmod(s, 60));
}

/// `warning: ` or `error: `; a note has none.
class LevelPrefix : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& text) override {
    if (message.level < spdlog::level::warn) return;
    text.append(spdlog::level::to_string_view(message.level));
    text.append(std::string_view(": "));
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<LevelPrefix>(); }
};

std::shared_ptr<spdlog::logger> open_terminal_log(const std::string& name, bool quiet) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<LevelPrefix>('*').set_pattern("%n: %*%v");
  auto log = std::make_shared<spdlog::logger>(name, std::make_shared<spdlog::sinks::stderr_sink_st>());
  log->set_formatter(std::move(formatter));
  log->set_level(quiet ? spdlog::level::warn : spdlog::level::info);
  return log;
}

spdlog::level::level_enum level_named(const std::string& name) {
  if (name == "note") return spdlog::level::info;
  if (name == "warning") return spdlog::level::warn;
  return name == "error" ? spdlog::level::err : spdlog::level::off;
}

/// Whether a log may be appended to a file: a new or empty file, a log of Patchlight, a pipe or a device.
bool takes_log(const std::string& file) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(file, fault) || std::filesystem::file_size(file, fault) == 0) return true;
  std::string line(1 << 20, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(line.data(), std::streamsize(line.size()));
  line.resize(std::size_t(stream.gcount()));
  line.resize(std::min(line.find('\n'), line.size()));
  const nlohmann::json first = nlohmann::json::parse(line, nullptr, false);
  return first.is_object() && first.contains("stage") && first.contains("level");
}

}  // namespace

Progress::Progress(Options options)
    : options_(std::move(options)),
      terminal_log_(open_terminal_log("patchlight-" + options_.stage, options_.quiet)),
      terminal_(isatty(STDERR_FILENO) == 1) {
  if (!options_.log_json_file.empty()) open_json_log();
}

Progress::~Progress() {
  clear_line();
}

void Progress::open_json_log() {
  const std::string& file = options_.log_json_file;
  if (!takes_log(file))
    throw Error(ExitCode::cannot_create, "not a JSON log of Patchlight", file, "choose another --log-json");
  json_file_.open(file, std::ios::binary | std::ios::app);
  if (!json_file_) throw Error(ExitCode::cannot_create, "cannot open the log", file, "choose another --log-json");
  json_file_.exceptions(std::ios::badbit);
  json_log_ = std::make_shared<spdlog::logger>(
      "json", std::make_shared<spdlog::sinks::ostream_sink_st>(json_file_, /*force_flush=*/true));
  json_log_->set_pattern("%v");
  json_log_->set_error_handler([this](const std::string&) {
    json_failed_ = true;
    clear_line();
    terminal_log_->warn(fmt::format("cannot write the log ({}): check the space on the disk", options_.log_json_file));
  });
}

void Progress::note(const std::string& message) {
  clear_line();
  terminal_log_->info(message);
  write_json("note", message);
}

void Progress::warning(const std::string& message) {
  warnings_.push_back(message);
  transient_warning(message);
}

void Progress::transient_warning(const std::string& message) {
  clear_line();
  terminal_log_->warn(message);
  write_json("warning", message);
}

void Progress::error(const std::string& message, int exit_code) {
  clear_line();
  terminal_log_->error(message);
  write_json("error", message, exit_code);
}

void Progress::pass_on(const nlohmann::json& line) {
  const auto text = [&](const char* key) {
    return line.is_object() && line.contains(key) && line[key].is_string() ? line[key].get<std::string>() : "";
  };
  const spdlog::level::level_enum level = level_named(text("level"));
  if (level == spdlog::level::off) return;
  clear_line();
  terminal_log_->clone("patchlight-" + text("stage"))->log(level, text("message"));
  write_line(line);
}

void Progress::repeat_warning(const std::string& stage, const std::string& message) {
  nlohmann::json line = json_line("warning", message);
  line["stage"] = stage;
  line["repeated"] = true;
  pass_on(line);
}

double Progress::seconds() const {
  return in_seconds(Clock::now() - start_);
}

void Progress::update(double fraction, const std::string& detail, std::int64_t rays) {
  check_interrupted();
  fraction = fraction >= 0 ? std::min(fraction, 1.0) : 0.0;  // NaN becomes 0
  fraction = part_begin_ + fraction * (part_end_ - part_begin_);
  const Clock::time_point now = Clock::now();
  if (fraction < last_fraction_) {
    whole_start_ = part_start_ = last_update_;
    start_fraction_ = part_begin_;
  }
  last_fraction_ = fraction;
  last_update_ = now;
  const auto is_due = [&](Clock::time_point& last, double interval) {
    if (in_seconds(now - std::max(last, start_)) < interval) return false;
    last = now;
    return true;
  };
  const bool log = json_log_ && is_due(last_logged_, kLogInterval);
  const bool show = !options_.quiet && is_due(last_shown_, terminal_ ? kTerminalInterval : kFileInterval);
  if (!log && !show) return;
  const double spent = in_seconds(now - part_start_);
  const double rate = rays > 0 && spent > 0 ? double(rays) / spent : 0.0;
  if (log) write_json("progress", detail, -1, fraction, rate);
  if (!show) return;
  std::string line = fmt::format("{:3.0f}%  {}", 100 * fraction, detail);
  if (rate > 0) line += fmt::format("  {:.3g} million rays/s", rate * 1e-6);
  if (const double done = fraction - start_fraction_; done > 0.01)
    line += "  " + duration_text(in_seconds(now - whole_start_) * (1 - fraction) / done) + " left";
  if (!terminal_) return terminal_log_->info(line);
  line = "patchlight-" + options_.stage + ": " + line;
  winsize size{};  // a line that wraps could not be cleared
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && line.size() >= size.ws_col)
    line.resize(std::size_t(size.ws_col - 1));
  print_error("\r\033[K" + line);
  line_open_ = true;
}

void Progress::set_part(double begin, double end) {
  if (last_fraction_ <= part_begin_ && begin > part_begin_)
    start_fraction_ = last_fraction_ = begin;  // a part left out
  part_begin_ = begin;
  part_end_ = end;
  part_start_ = Clock::now();
}

void Progress::set_part(std::size_t part, std::size_t count) {
  set_part(double(part) / double(count), double(part + 1) / double(count));
}

void Progress::set_job(const std::string& job, const std::string& output) {
  job_ = job;
  output_ = output;
}

void Progress::result(const StageResult& result) {
  if (!json_log_) return;
  nlohmann::json line = json_line("result", result.state);
  line["target"] = result.stage;
  line["exit_code"] = result.exit_code;
  line["wall_seconds"] = result.wall_seconds;
  line["cpu_seconds"] = result.cpu_seconds;
  line["peak_bytes"] = result.peak_bytes;
  write_line(line);
}

void Progress::check_interrupted() {
  if (stop_requested) throw Error(ExitCode::interrupted, "interrupted", "", "run again to continue");
}

void Progress::catch_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void Progress::pass_signals_to(int process) {
  informed_process = process;
  if (process > 0 && stop_requested) kill(pid_t(process), stop_requested);
}

nlohmann::json Progress::json_line(const char* level, const std::string& message) const {
  nlohmann::json line{{"stage", options_.stage}, {"level", level}, {"message", message}, {"seconds", seconds()}};
  if (!job_.empty()) line["job"] = job_;
  if (!output_.empty()) line["output"] = output_;
  return line;
}

void Progress::write_line(const nlohmann::json& line) {
  if (!json_log_ || json_failed_) return;
  json_log_->info(line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void Progress::write_json(const char* level, const std::string& message, int exit_code, double fraction,
                          double rays_per_second) {
  if (!json_log_) return;
  nlohmann::json line = json_line(level, message);
  if (fraction >= 0) line["fraction"] = fraction;
  if (rays_per_second > 0) line["rays_per_second"] = rays_per_second;
  if (exit_code >= 0) line["exit_code"] = exit_code;
  write_line(line);
}

void Progress::clear_line() {
  if (line_open_) print_error("\r\033[K");
  line_open_ = false;
}

}  // namespace patchlight
