#include "pipeline/driver/slurm/slurm_script.h"

#include <fmt/format.h>

#include <fstream>

#include "pipeline/system/text_scanner.h"

namespace patchlight {

namespace {

/// Text quoted as one shell word.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// STAGE.EXTENSION or STAGE.TASK.JOB.EXTENSION.
bool is_slurm_file(const std::string& name) {
  TextScanner text(name);
  if (!text.skip_any({"import.", "rows.", "solve.", "trace."})) return false;
  if (!text.take_digits().empty() && !(text.skip(".") && !text.take_digits().empty() && text.skip("."))) return false;
  for (const std::string_view extension : {"sh", "log", "jsonl", "end", "end.new"})
    if (text.rest() == extension) return true;
  return false;
}

}  // namespace

std::filesystem::path slurm_folder(const Job& job) {
  return std::filesystem::absolute(job.output) / "slurm";
}

std::vector<std::filesystem::path> slurm_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code fault;
  for (std::filesystem::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault))
    if (is_slurm_file(entry->path().filename().string())) files.push_back(entry->path());
  return files;
}

std::filesystem::path slurm_task_file(const std::filesystem::path& folder, const std::string& stage, int task,
                                      const std::string& job, const std::string& extension) {
  return folder / fmt::format("{}.{}.{}.{}", stage, task, job, extension);
}

std::string slurm_script(const SlurmStage& stage, const std::filesystem::path& folder) {
  std::string command = quoted(stage.command.at(0));
  if (stage.shards > 0) command += fmt::format(" --shard \"$task/{}\"", stage.shards);
  command += " --log-json \"$place.jsonl\"";
  for (std::size_t i = 1; i < stage.command.size(); ++i) command += " " + quoted(stage.command[i]);
  // Slurm signals the script and the program together; the script must outlive the program.
  return fmt::format(
      R"sh(#!/bin/sh
# Written by `patchlight run` for Slurm.
task={task}
place={place}.$task.{job}
exec >>"$place.log" 2>&1
trap : TERM
begin=$(date +%s.%N)
{command}
code=$?
LC_ALL=C
{{ echo "$code $begin $(date +%s.%N)"; times; }} >"$place.end.new" && mv "$place.end.new" "$place.end"
exit $code
)sh",
      fmt::arg("task", stage.shards > 0 ? "$SLURM_ARRAY_TASK_ID" : "1"),
      fmt::arg("place", quoted((folder / stage.name).string())),
      fmt::arg("job", stage.shards > 0 ? "$SLURM_ARRAY_JOB_ID" : "$SLURM_JOB_ID"), fmt::arg("command", command));
}

std::optional<SlurmTaskEnd> read_task_end(const std::filesystem::path& file) {
  std::ifstream stream(file);
  SlurmTaskEnd task;
  if (!(stream >> task.exit_code >> task.begin >> task.end)) return std::nullopt;
  double minutes = 0, seconds = 0;
  char m = 0, s = 0;
  for (int k = 0; k < 4 && stream >> minutes >> m >> seconds >> s; ++k) task.cpu_seconds += 60 * minutes + seconds;
  return task;
}

}  // namespace patchlight
