#include "pipeline/driver/slurm/slurm_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipeline/model/error.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

using namespace std::chrono_literals;

constexpr auto kMinPoll = 100ms;                // between two polls of the task files
constexpr auto kPollPerTask = 5ms;              // there may be a thousand tasks on a shared disk
constexpr auto kSqueue = 4s, kSqueueSoon = 1s;  // between two squeue calls; if a task seems to be lost
constexpr auto kMaxSilence = 10min;             // without an answer of Slurm
constexpr int kUnseen = 2, kLate = 60;          // squeue answers; the end file of a completed task may appear late

/// Whether a task was killed by a signal.
bool is_killed(int exit_code) {
  constexpr int kBySignal = 128;  // a shell adds the signal number
  constexpr std::array kSignals{SIGHUP, SIGINT, SIGKILL, SIGTERM};
  return exit_code == int(ExitCode::interrupted) ||
         std::find(kSignals.begin(), kSignals.end(), exit_code - kBySignal) != kSignals.end();
}

/// One of the documented exit codes, whatever the shell returned.
ExitCode contract_code(int exit_code) {
  const bool not_started = exit_code == 126 || exit_code == 127;
  if (not_started) return ExitCode::unavailable;
  return exit_code >= int(ExitCode::usage) && exit_code <= int(ExitCode::bad_config) ? ExitCode(exit_code)
                                                                                     : ExitCode::internal;
}

}  // namespace

bool SlurmChain::Stage::done() const {
  return std::all_of(tasks.begin(), tasks.end(), [](const Task& task) { return task.done; });
}

bool SlurmChain::Stage::submitted() const {
  return std::all_of(tasks.begin(), tasks.end(), [](const Task& task) { return task.done || !task.job.empty(); });
}

void SlurmChain::run(const std::vector<SlurmStage>& stages, const Done& done) {
  stages_.clear();
  for (const SlurmStage& stage : stages) {
    stages_.push_back({stage, {}});
    for (const int task : stage.tasks) stages_.back().tasks.push_back({task});
    write_text(folder_ / (stage.name + ".sh"), slurm_script(stage, folder_));
  }
  front_ = 0;
  asked_ = answered_ = Clock::now();
  try {
    submit_from(0);
    while (advance(done))
      std::this_thread::sleep_for(std::max<Clock::duration>(kMinPoll, stages_[front_].tasks.size() * kPollPerTask));
  } catch (...) {
    try {
      client_.cancel();
    } catch (const Error&) {  // the first error says more
    }
    throw;
  }
}

/// Submits the tasks of these stages that are neither done nor submitted.
void SlurmChain::submit_from(std::size_t first) {
  std::vector<std::string> after;
  for (std::size_t i = first; i < stages_.size(); ++i) {
    Stage& stage = stages_[i];
    SlurmClient::Request request{stage.what.name, folder_ / (stage.what.name + ".sh"), {}, after};
    bool any = false;
    for (const Task& task : stage.tasks) {
      if (task.done || !task.job.empty()) continue;
      any = true;
      if (stage.is_array()) request.tasks.push_back(task.index);
    }
    const std::string job = any ? client_.submit(request) : "";
    after.clear();
    for (Task& task : stage.tasks) {
      if (!task.done && task.job.empty()) task.job = job;
      if (!task.done) after.push_back(id(stage, task));
    }
    if (request.tasks.size() == stage.tasks.size()) after = {job};
  }
}

/// Resubmits the lost tasks of the running stage, and the stages after it.
void SlurmChain::submit_again() {
  const Clock::time_point now = Clock::now();
  if (!stages_[front_].submitted()) {
    std::vector<std::string> later;
    for (std::size_t i = front_ + 1; i < stages_.size(); ++i)
      for (Task& task : stages_[i].tasks) {
        if (!task.job.empty() && std::find(later.begin(), later.end(), task.job) == later.end())
          later.push_back(task.job);
        task.job.clear();
      }
    client_.cancel(later);
  }
  if (refused_ && now - asked_to_submit_ < kSqueue) return;
  asked_to_submit_ = now;
  try {
    submit_from(front_);
    refused_.reset();
  } catch (const Error& error) {  // Slurm may be restarting
    if (error.code() != ExitCode::unavailable || (refused_ && now - *refused_ > kMaxSilence)) throw;
    if (refused_) return;
    refused_ = now;
    progress_.warning(fmt::format("{}: retrying for ten minutes", error.what()));
  }
}

/// Polls the task files. Returns false when all stages are done.
bool SlurmChain::advance(const Done& done) {
  Progress::check_interrupted();
  Stage& stage = stages_[front_];
  for (Task& task : stage.tasks)
    if (!task.done && !task.job.empty()) look_at(stage, task);
  if (stage.done()) {
    double begin = 1e300, end = 0, cpu = 0;
    for (const Task& task : stage.tasks) {
      begin = std::min(begin, task.end.begin);
      end = std::max(end, task.end.end);
      cpu += task.end.cpu_seconds;
    }
    done(stage.what, std::max(end - begin, 0.0), cpu);
    return ++front_ < stages_.size();
  }
  const bool doubt = std::any_of(stage.tasks.begin(), stage.tasks.end(), [](const Task& t) { return t.unseen > 0; });
  if (Clock::now() - asked_ > (doubt ? kSqueueSoon : kSqueue)) ask_slurm(stage);
  if (!std::all_of(stages_.begin() + std::ptrdiff_t(front_), stages_.end(),
                   [](const Stage& each) { return each.submitted(); }))
    submit_again();
  show(stage);
  return true;
}

void SlurmChain::look_at(Stage& stage, Task& task) {
  const auto end = read_task_end(file(stage, task, "end"));
  listen(stage, task);
  if (!end) return;
  if (end->exit_code == 0) {
    task.done = true;
    task.end = *end;
    task.fraction = 1;
  } else if (is_killed(end->exit_code)) {
    lose(stage, task, "was killed");
  } else {
    const ExitCode code = contract_code(end->exit_code);
    throw Error(code, fmt::format("{} failed with exit code {}", name(stage, task), end->exit_code),
                file(stage, task, "log").string(),
                code == ExitCode::unavailable ? "see its log; all nodes must see this program's folder"
                                              : "see its messages above and in its log");
  }
}

/// Finds tasks of the stage that ended without an end file.
void SlurmChain::ask_slurm(Stage& stage) {
  const auto states = client_.states();
  asked_ = Clock::now();
  if (!states) {
    if (asked_ - answered_ < kMaxSilence) return;
    throw Error(ExitCode::unavailable, "Slurm has not answered for ten minutes", "squeue", "run again to continue");
  }
  answered_ = asked_;
  waits_for_.clear();
  for (Task& task : stage.tasks) {
    if (task.done || task.job.empty()) continue;
    const auto state = states->find(id(stage, task));
    task.runs = state != states->end() && state->second.name == "RUNNING";
    if (state != states->end() && state->second.active) {
      task.unseen = 0;
      if (!task.runs) waits_for_ = state->second.reason;
    } else if (++task.unseen >= (state != states->end() && state->second.name == "COMPLETED" ? kLate : kUnseen)) {
      lose(stage, task, state == states->end() ? "was lost" : "was lost: " + state->second.name);
    }
  }
}

/// Forwards the log lines that a task has written since the last call.
void SlurmChain::listen(const Stage& stage, Task& task) {
  std::ifstream stream(file(stage, task, "jsonl"), std::ios::binary);
  stream.seekg(task.heard);
  for (std::string text; std::getline(stream, text) && !stream.eof();) {
    task.heard = stream.tellg();
    const nlohmann::json line = nlohmann::json::parse(text, nullptr, false);
    if (!line.is_object()) continue;
    if (line.contains("fraction") && line["fraction"].is_number())
      task.fraction = std::clamp(line["fraction"].get<double>(), 0.0, 1.0);
    // The tasks of an array repeat each other's warnings.
    if (line.value("level", "") == "warning" && !warnings_.insert(line.value("message", "")).second) continue;
    progress_.pass_on(line);
  }
}

/// Marks a task for resubmission.
void SlurmChain::lose(const Stage& stage, Task& task, const std::string& how) {
  const std::string log = file(stage, task, "log").string();
  if (++task.losses > retries_)
    throw Error(ExitCode::interrupted, fmt::format("{} {}, {} times", name(stage, task), how, task.losses), log,
                "see its log; then run again to continue, perhaps with more slurm.time or memory in slurm.options. "
                "All nodes must see the output folder");
  progress_.warning(fmt::format("{} {} ({}): resubmitted", name(stage, task), how, log));
  task.job.clear();
  task.fraction = 0;
  task.heard = 0;
  task.unseen = 0;
  task.runs = false;
}

void SlurmChain::show(const Stage& stage) {
  double fraction = 0;
  int finished = 0, running = 0;
  for (const Task& task : stage.tasks) {
    fraction += task.fraction / double(stage.tasks.size());
    finished += task.done;
    running += !task.done && (task.runs || task.fraction > 0);
  }
  std::string detail =
      fmt::format("{}: {} of {} tasks done, {} running", stage.what.name, finished, stage.tasks.size(), running);
  if (!waits_for_.empty() && waits_for_ != "None") detail += ", pending: " + waits_for_;
  progress_.set_part(front_, stages_.size());
  progress_.update(fraction, detail);
}

std::string SlurmChain::name(const Stage& stage, const Task& task) const {
  return stage.is_array() ? fmt::format("task {} of {} of `{}`", task.index, stage.what.shards, stage.what.name)
                          : fmt::format("`{}`", stage.what.name);
}

std::filesystem::path SlurmChain::file(const Stage& stage, const Task& task, const std::string& extension) const {
  return slurm_task_file(folder_, stage.what.name, task.index, task.job, extension);
}

std::string SlurmChain::id(const Stage& stage, const Task& task) const {
  return stage.is_array() ? fmt::format("{}_{}", task.job, task.index) : task.job;
}

}  // namespace patchlight
