#include "pipeline/driver/commands/batch.h"

#include <fmt/format.h>

#include <functional>

#include "pipeline/driver/commands/run.h"
#include "pipeline/driver/stages/job_variants.h"
#include "pipeline/driver/stages/run_command.h"
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
  bool interrupted = false;
  /// Returns whether `body` succeeded; records its error or exit code as a result.
  const auto attempt = [&](const std::string& label, const std::function<int(std::string&)>& body) {
    Result result{label, 0, ""};
    int code = 0;
    const int failure = report_errors("run", progress, [&] { code = body(result.account); });
    result.exit_code = failure != 0 ? failure : code;
    interrupted = result.exit_code == int(ExitCode::interrupted);
    results.push_back(result);
    return result.exit_code == 0;
  };
  for (std::size_t i = 0; i < command.job_files.size() && !interrupted; ++i) {
    const std::string& job_file = command.job_files[i];
    std::vector<JobVariant> variants;
    if (!attempt(job_file, [&](std::string&) {
          variants = job_variants(job_file, command.common, command.variant);
          return 0;
        }))
      continue;
    results.pop_back();  // its variants are counted instead
    for (std::size_t k = 0; k < variants.size() && !interrupted; ++k) {
      const JobVariant& variant = variants[k];
      progress.set_job(job_file, variant.options.output);
      if (command.job_files.size() + variants.size() > 2) progress.note("job " + variant.label());
      const RunCommand run{job_file,        command.force, variant.options,     "trace",
                           command.explain, variant.cache, variant.job_template};
      attempt(variant.label(), [&](std::string& account) { return run_job(run, progress, &account); });
    }
  }
  progress.set_job("", "");
  if (results.size() > 1) sum_up(results, progress.seconds(), progress);
  if (interrupted) return int(ExitCode::interrupted);
  for (const Result& result : results)
    if (result.exit_code != 0) return result.exit_code;
  return 0;
}

}  // namespace patchlight
