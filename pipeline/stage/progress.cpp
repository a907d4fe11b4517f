#include "pipeline/stage/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

volatile std::sig_atomic_t stop_requested = 0;  ///< The signal that did.
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

}  // namespace

Progress::Progress(Options options) : options_(std::move(options)), terminal_(isatty(STDERR_FILENO) == 1) {
  if (options_.log_json_file.empty()) return;
  json_ = {std::fopen(options_.log_json_file.c_str(), "ab"), std::fclose};
  if (!json_)
    throw Error(ExitCode::cannot_create, "cannot open the log", options_.log_json_file, "choose another --log-json");
}

Progress::~Progress() {
  clear_line();
}

void Progress::note(const std::string& message) {
  clear_line();
  if (!options_.quiet) fmt::print(stderr, "patchlight-{}: {}\n", options_.stage, message);
  write_json("note", message, -1, -1);
}

void Progress::warning(const std::string& message) {
  warnings_.push_back(message);
  clear_line();
  fmt::print(stderr, "patchlight-{}: warning: {}\n", options_.stage, message);
  write_json("warning", message, -1, -1);
}

void Progress::error(const std::string& message, int exit_code) {
  clear_line();
  fmt::print(stderr, "patchlight-{}: error: {}\n", options_.stage, message);
  write_json("error", message, -1, exit_code);
}

double Progress::seconds() const {
  return in_seconds(Clock::now() - start_);
}

void Progress::update(double fraction, const std::string& detail) {
  check_interrupted();
  fraction = fraction >= 0 ? std::min(fraction, 1.0) : 0.0;  // NaN is not at least zero
  const Clock::time_point now = Clock::now();
  const double interval = terminal_ ? 0.1 : 5.0;
  if (in_seconds(now - std::max(last_shown_, start_)) < interval) return;
  last_shown_ = now;
  write_json("progress", detail, fraction, -1);
  if (options_.quiet) return;
  const double spent = seconds();
  const std::string left = fraction > 0.01 ? duration_text(spent * (1 / fraction - 1)) + " left" : "";
  const std::string line = fmt::format("patchlight-{}: {:3.0f}%  {}  {}", options_.stage, 100 * fraction, detail, left);
  if (terminal_) {
    fmt::print(stderr, "\r\033[K{}", line);
    line_open_ = true;
  } else {
    fmt::print(stderr, "{}\n", line);
  }
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

void Progress::write_json(const char* level, const std::string& message, double fraction, int exit_code) {
  if (!json_) return;
  nlohmann::json line{{"stage", options_.stage}, {"level", level}, {"message", message}, {"seconds", seconds()}};
  if (fraction >= 0) line["fraction"] = fraction;
  if (exit_code >= 0) line["exit_code"] = exit_code;
  const std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  std::fwrite(text.data(), 1, text.size(), json_.get());
  std::fflush(json_.get());
}

void Progress::clear_line() {
  if (line_open_) fmt::print(stderr, "\r\033[K");
  line_open_ = false;
}

}  // namespace patchlight
