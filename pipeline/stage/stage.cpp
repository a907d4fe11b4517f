#include "pipeline/stage/stage.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <new>
#include <optional>
#include <regex>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"
#include "pipeline/system/large_pages.h"

namespace patchlight {

std::string patchlight_version() {
  return "patchlight " PATCHLIGHT_VERSION;
}

void add_common_options(CLI::App& app, CommonOptions& options) {
  app.add_option("--set", options.sets, "Override a key of the job: key.path=value")->allow_extra_args(false);
  app.add_option("--output", options.output, "Folder for outputs, instead of the job's")
      ->check([](const std::string& folder) { return folder.empty() ? std::string("an empty name") : std::string(); });
  app.add_option("--threads", options.threads, "Number of threads; absent: all")->check(CLI::Range(1, 4096));
  app.add_option("--memory", options.memory, "Refuse a solve that needs more, as 8GiB; absent: what the machine has")
      ->transform(CLI::AsSizeValue(false));
  app.add_flag("--quiet", options.quiet, "Print warnings and errors alone");
  app.add_option("--log-json", options.log_json, "Append one JSON object a line to this file");
  app.set_version_flag("--version", patchlight_version());
}

CLI::Option* add_shard_option(CLI::App& app, std::optional<Shard>& shard, const std::string& help) {
  const auto read = [&shard](const std::string& text) {
    static const std::regex parts("([0-9]{1,4})/([0-9]{1,4})");
    std::smatch numbers;
    if (!std::regex_match(text, numbers, parts)) return false;
    shard = {std::stoi(numbers[1]), std::stoi(numbers[2])};
    return shard->index >= 1 && shard->index <= shard->count && shard->count <= kMostShards;
  };
  return app
      .add_option_function<std::string>(
          "--shard", [](const std::string&) {}, help)
      ->type_name("k/K")
      ->check([read](const std::string& text) {
        return read(text) ? std::string() : fmt::format("expected k/K with 1 <= k <= K <= {}", kMostShards);
      });
}

std::optional<int> parse_options(CLI::App& app, const std::string& name, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::string line = name;
    for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
    fmt::print(stderr, "{}: error: {} ({}): see {} --help\n", name, error.what(), line, name);
    return int(ExitCode::usage);
  }
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
    fmt::print(stderr, "patchlight-{}: error: {}\n", stage, error.what());
    return int(error.code());
  }
  return report_errors(stage, *progress, [&] { body(*progress); });
}

Provenance provenance(const Job& job, const Progress& progress) {
  Job kept = job;
  kept.output.clear();  // the same wherever it is put
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
              const std::function<void(CLI::App&)>& more) {
  use_large_pages();
  CLI::App app{"Runs the stage `" + stage + "` of a Patchlight job.", "patchlight-" + stage};
  std::string job_file;
  CommonOptions options;
  app.add_option("JOB.yaml", job_file, "The job file")->required();
  add_common_options(app, options);
  if (more) more(app);
  app.footer(job_key_help);
  if (const auto exit_code = parse_options(app, "patchlight-" + stage, argc, argv)) return *exit_code;
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
