#include <fmt/format.h>

#include <chrono>

#include "pipeline/driver/commands.h"
#include "pipeline/driver/job_variants.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

struct Result {
  std::string label;
  int exit_code = 0;
  std::string account;
};

void sum_up(const std::vector<Result>& results, double seconds, Progress& progress) {
  std::size_t failed = 0;
  for (const Result& result : results) failed += result.exit_code != 0;
  for (const Result& result : results)
    progress.note(fmt::format("{:<10}{}: {}",
                              result.exit_code == 0 ? "done" : fmt::format("failed {}", result.exit_code), result.label,
                              result.account.empty() ? "nothing ran" : result.account));
  progress.note(
      fmt::format("{} of {} done, {} failed, in {:.1f} s", results.size() - failed, results.size(), failed, seconds));
}

}  // namespace

int run_jobs(const BatchCommand& command, Progress& progress) {
  Progress::catch_signals();
  if (command.job_files.size() > 1 && !command.common.output.empty())
    throw Error(ExitCode::usage, "one output folder of several jobs", "--output " + command.common.output,
                "leave it out, or run them one by one");
  std::vector<Result> results;
  const auto attempt = [&](const std::string& label, const std::function<int(std::string&)>& body) {
    Result result{label, 0, ""};
    int code = 0;
    const int failure = report_errors("run", progress, [&] { code = body(result.account); });
    result.exit_code = failure != 0 ? failure : code;
    results.push_back(result);
    return result.exit_code != int(ExitCode::interrupted);
  };
  bool on = true;
  for (const std::string& job_file : command.job_files) {
    std::vector<JobVariant> variants;
    const auto find = [&](std::string&) {
      return variants = job_variants(job_file, command.common, command.variant), 0;
    };
    if (on && (on = attempt(job_file, find)) && results.back().exit_code == 0) results.pop_back();
    for (const JobVariant& variant : variants) {
      if (!on) break;
      const CommonOptions& options = variant.options;
      progress.set_job(variant.job_file, options.output);
      if (command.job_files.size() + variants.size() > 2) progress.note("job " + variant.label());
      const RunCommand run{job_file, command.force, options, "trace", command.explain, variant.cache};
      on = attempt(variant.label(), [&](std::string& account) { return run_job(run, progress, &account); });
    }
  }
  progress.set_job("", "");
  if (results.size() > 1) sum_up(results, progress.seconds(), progress);
  if (!on) return int(ExitCode::interrupted);
  for (const Result& result : results)
    if (result.exit_code != 0) return result.exit_code;
  return 0;
}

}  // namespace patchlight
