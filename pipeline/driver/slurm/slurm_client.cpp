#include "pipeline/driver/slurm/slurm_client.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "pipeline/model/error.h"
#include "pipeline/stage/progress.h"
#include "pipeline/system/child_process.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

constexpr std::array<const char*, 4> kStages{"import", "rows", "solve", "trace"};

ProgramOutput ask_slurm(const std::string& program, const std::vector<std::string>& arguments) {
  return capture_program(program, arguments,
                         "install Slurm's programs (Debian: slurm-client) and run where its cluster is, or leave out "
                         "`executor: slurm`");
}

/// Array indices in the notation of --array: 1,3-5.
std::string ranges(const std::vector<int>& tasks) {
  std::string text;
  for (std::size_t i = 0; i < tasks.size();) {
    std::size_t last = i;
    while (last + 1 < tasks.size() && tasks[last + 1] == tasks[last] + 1) ++last;
    text += fmt::format("{}{}", i > 0 ? "," : "", tasks[i]);
    if (last > i) text += fmt::format("-{}", tasks[last]);
    i = last + 1;
  }
  return text;
}

bool is_active(const std::string& state) {
  static constexpr std::array<const char*, 11> kEnded{"BOOT_FAIL", "CANCELLED", "COMPLETED",     "DEADLINE",
                                                      "FAILED",    "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED",
                                                      "REVOKED",   "TIMEOUT",   "LAUNCH_FAILED"};
  return std::find(kEnded.begin(), kEnded.end(), state) == kEnded.end();
}

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

SlurmClient::SlurmClient(const Job& job, int cpus)
    : config_(job.slurm),
      cpus_(cpus),
      folder_(KeyHasher().add(std::filesystem::weakly_canonical(job.output).string()).hex().substr(0, 16)) {}

std::string SlurmClient::submit(const Request& request) const {
  std::vector<std::string> arguments = config_.options;
  const auto add = [&](const std::string& option, const std::string& value) {
    if (!value.empty()) arguments.push_back("--" + option + "=" + value);
  };
  add("partition", config_.partition);
  add("time", config_.time);
  add("job-name", name(request.stage));
  add("output", "/dev/null");  // the script redirects its output itself: Slurm would expand patterns in folder names
  add("ntasks", "1");
  add("cpus-per-task", std::to_string(cpus_));
  add("array", ranges(request.tasks));
  if (!request.after.empty()) add("dependency", fmt::format("afterok:{}", fmt::join(request.after, ":")));
  arguments.insert(arguments.end(),
                   {"--kill-on-invalid-dep=yes", "--no-requeue", "--parsable", request.script.string()});
  const ProgramOutput answer = ask_slurm("sbatch", arguments);
  Progress::check_interrupted();
  const std::string job = answer.out.substr(0, answer.out.find_first_not_of("0123456789"));
  if (answer.exit_code != 0 || job.empty())
    throw Error(ExitCode::unavailable, "Slurm refuses the stage: " + one_line(answer.err), "sbatch, " + request.stage,
                "look at `sinfo` and at `slurm` in the job");
  return job;
}

std::optional<std::map<std::string, SlurmClient::TaskState>> SlurmClient::states() const {
  const ProgramOutput answer =
      ask_slurm("squeue", {"--noheader", "--array", "--states=all", "--name=" + names(), "--format=%i|%T|%r"});
  if (answer.exit_code != 0) return std::nullopt;
  std::map<std::string, TaskState> states;
  std::istringstream lines(answer.out);
  for (std::string id, state, reason;
       std::getline(lines, id, '|') && std::getline(lines, state, '|') && std::getline(lines, reason);)
    states[id] = {state, reason, is_active(state)};
  return states;
}

void SlurmClient::cancel() const {
  for (const char* stage : kStages) ask_slurm("scancel", {"--quiet", "--name=" + name(stage)});
}

void SlurmClient::cancel(const std::vector<std::string>& jobs) const {
  if (jobs.empty()) return;
  std::vector<std::string> arguments{"--quiet"};
  arguments.insert(arguments.end(), jobs.begin(), jobs.end());
  ask_slurm("scancel", arguments);
}

std::string SlurmClient::names() const {
  std::string all;
  for (const char* stage : kStages) all += (all.empty() ? "" : ",") + name(stage);
  return all;
}

}  // namespace patchlight
