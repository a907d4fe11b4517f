#include "pipeline/stage/stage.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <new>
#include <optional>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"
#include "pipeline/system/large_pages.h"
#include "pipeline/system/standard_streams.h"

namespace patchlight {

Option job_argument(std::string& file) {
  return {.name = "JOB.yaml",
          .value = &file,
          .help = "The job file, or a scene (.glb, .gltf, .blend) to run with all defaults",
          .required = true,
          .completion = Option::Completion::file};
}

Option job_argument(std::vector<std::string>& files) {
  return {.name = "JOB.yaml",
          .value = &files,
          .help = "The job files, or scenes (.glb, .gltf, .blend) to run with all defaults",
          .required = true,
          .completion = Option::Completion::file};
}

std::vector<Option> common_options(CommonOptions& values) {
  using Completion = Option::Completion;
  return {
      {.name = "--set", .value = &values.sets, .help = "Override a key of the job: key.path=value"},
      {.name = "--output",
       .value = &values.output,
       .help = "Folder for outputs, instead of the job's",
       .not_empty = true,
       .completion = Completion::folder},
      {.name = "--threads", .value = &values.threads, .help = "Number of threads; absent: all", .range = {{1, 4096}}},
      {.name = "--memory",
       .value = &values.memory,
       .help = "Refuse a solve that needs more, as 8GiB; absent: what the machine has"},
      {.name = "--quiet", .value = &values.quiet, .help = "Print warnings and errors alone"},
      {.name = "--log-json",
       .value = &values.log_json,
       .help = "Append one JSON object a line to this file",
       .completion = Completion::file},
  };
}

int report_errors(const std::string& stage, Progress& progress, const std::function<void()>& body) {
  const auto fail = [&](ExitCode code, const std::string& message) {
    progress.error(message, int(code));
    return int(code);
  };
  try {
    body();
    return int(ExitCode::ok);
  } catch (const Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::over_limit, std::string("out of memory: use a ") +
                                          (stage == "trace" ? "smaller trace.resolution" : "larger import.patch_area") +
                                          ", or a machine with more memory");
  } catch (const std::exception& error) {
    return fail(ExitCode::internal, fmt::format("internal fault ({}): please report it", error.what()));
  }
}

int with_progress(const std::string& stage, const CommonOptions& options, const std::function<void(Progress&)>& body) {
  std::unique_ptr<Progress> progress;
  try {
    progress = std::make_unique<Progress>(Progress::Options{stage, options.quiet, options.log_json});
  } catch (const Error& error) {
    print_error(fmt::format("patchlight-{}: error: {}\n", stage, error.what()));
    return int(error.code());
  }
  return report_errors(stage, *progress, [&] { body(*progress); });
}

Provenance provenance(const Job& job, const Progress& progress) {
  Job kept = job;
  kept.output.clear();  // outputs are equal in every folder
  kept.bench = {};
  kept.matrix.clear();
  kept.executor = Job().executor;
  kept.slurm = {};
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  return {effective_job(kept), progress.warnings(), progress.seconds(),
          seconds(usage.ru_utime) + seconds(usage.ru_stime), std::int64_t(usage.ru_maxrss) * 1024};
}

int run_stage(const std::string& stage, int argc, char** argv, const std::function<void(const Job&, Progress&)>& body,
              const std::vector<Option>& more) {
  use_large_pages();
  std::string job_file;
  CommonOptions options;
  Command program{.name = "patchlight-" + stage,
                  .purpose = "Runs the stage `" + stage + "` of a Patchlight job.",
                  .options = {job_argument(job_file)},
                  .footer = job_key_help};
  for (const auto& added : {common_options(options), more})
    program.options.insert(program.options.end(), added.begin(), added.end());
  if (const auto parsed = parse_command_line(program, argc, argv); parsed.exit_code) return *parsed.exit_code;
  return with_progress(stage, options, [&](Progress& progress) {
    Progress::catch_signals();
    progress.set_job(job_file, options.output);
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(options.threads));
    Job job = read_job(job_file, options.sets, options.output);
    job.solve.memory = options.memory;
    body(job, progress);
  });
}

}  // namespace patchlight
