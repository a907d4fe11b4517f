#include <CLI/CLI.hpp>

#include "pipeline/driver/bench/bench.h"
#include "pipeline/driver/clean.h"
#include "pipeline/driver/commands/batch.h"
#include "pipeline/driver/commands/diff.h"
#include "pipeline/driver/commands/info.h"
#include "pipeline/driver/commands/preview.h"
#include "pipeline/driver/commands/relight.h"
#include "pipeline/driver/commands/status.h"
#include "pipeline/driver/report/report.h"
#include "pipeline/job/reader/job_reader.h"

namespace {

using namespace patchlight;

/// A subcommand and what it does.
struct Command {
  CLI::App* app;
  const CommonOptions* options;
  std::function<int(Progress&)> act;
};

Command add_run(CLI::App& app) {
  static BatchCommand run;
  CLI::App* sub = app.add_subcommand("run", "Run whatever is stale of jobs and their variants: import, solve, trace");
  sub->add_option("JOB.yaml", run.job_files, "The job files")->required();
  sub->add_option("--variant", run.variant, "Only variants of the job's matrix with such a name (glob)");
  sub->add_flag("--force", run.force, "Run every stage, stale or not");
  sub->add_flag("--explain", run.explain, "Say all reasons for which stages run or do not");
  add_common_options(*sub, run.common);
  sub->footer(job_key_help);
  return {sub, &run.common, [](Progress& progress) { return run_jobs(run, progress); }};
}

Command add_status(CLI::App& app) {
  static StatusCommand status;
  CLI::App* sub = app.add_subcommand(
      "status", "List a job's stages and frames: fresh, stale, missing, damaged; exit code 1 unless all are fresh");
  sub->add_option("JOB.yaml", status.job_files, "The job files")->required();
  sub->add_option("--variant", status.variant, "Only variants of the job's matrix with such a name (glob)");
  add_common_options(*sub, status.common);
  sub->footer(job_key_help);
  return {sub, &status.common, [](Progress&) { return show_status(status); }};
}

Command add_clean(CLI::App& app) {
  static CleanCommand clean;
  CLI::App* sub = app.add_subcommand("clean", "Remove what a job keeps of earlier settings");
  sub->add_option("JOB.yaml", clean.job_file, "The job file")->required();
  sub->add_flag("--all", clean.all, "And all else that it made");
  add_common_options(*sub, clean.common);
  sub->footer(job_key_help);
  return {sub, &clean.common, [](Progress& progress) { return clean_job(clean, progress); }};
}

Command add_preview(CLI::App& app) {
  static PreviewCommand preview;
  CLI::App* sub = app.add_subcommand("preview", "Draw a job's patches, radiosity, irradiance or hemicubes");
  sub->add_option("JOB.yaml", preview.job_file, "The job file")->required();
  sub->add_option("--kind", preview.kind, "What to draw")
      ->check(CLI::IsMember({"patches", "radiosity", "irradiance", "hemicube"}))
      ->capture_default_str();
  sub->add_option("--camera", preview.camera, "From which camera; absent: the job's first");
  sub->add_option("--patch", preview.patch, "The patch to highlight, or whose hemicube to draw")
      ->check(CLI::NonNegativeNumber);
  add_common_options(*sub, preview.common);
  return {sub, &preview.common, [](Progress& progress) { return draw_preview(preview, progress); }};
}

Command add_relight(CLI::App& app) {
  static RelightCommand relight;
  CLI::App* sub = app.add_subcommand("relight",
                                     "Make frames under other `lights`, without a trace, from the layers "
                                     "`light_groups` of those that are there");
  sub->add_option("JOB.yaml", relight.job_file, "The job file")->required();
  sub->add_option("--variant", relight.variant, "Only variants of the job's matrix with such a name (glob)");
  sub->add_flag("--force", relight.force, "Make every frame, stale or not");
  sub->add_flag("--explain", relight.explain, "Say all reasons for which frames are made");
  add_common_options(*sub, relight.common);
  sub->footer(job_key_help);
  return {sub, &relight.common, [](Progress& progress) { return relight_jobs(relight, progress); }};
}

Command add_report(CLI::App& app) {
  static ReportCommand report;
  CLI::App* sub = app.add_subcommand(
      "report", "Write one HTML page of a job's frames, counts, times, convergence, errors, irradiance and warnings");
  sub->add_option("JOB.yaml", report.job_file, "The job file")->required();
  sub->add_option("--variant", report.variant, "Only variants of the job's matrix with such a name (glob)");
  add_common_options(*sub, report.common);
  sub->footer(job_key_help);
  return {sub, &report.common, [](Progress& progress) { return write_report_page(report, progress); }};
}

Command add_bench(CLI::App& app) {
  static BenchCommand bench;
  CLI::App* sub = app.add_subcommand(
      "bench", "Measure time, memory and error of a job over its `bench.sweep`; write tables, a plot and pictures");
  sub->add_option("JOB.yaml", bench.job_file, "The job file")->required();
  add_common_options(*sub, bench.common);
  sub->footer(job_key_help);
  return {sub, &bench.common, [](Progress& progress) { return bench_job(bench, progress); }};
}

Command add_info(CLI::App& app) {
  static InfoCommand info;
  static CommonOptions common;
  CLI::App* sub = app.add_subcommand("info", "Show what is in a glTF scene, patches.h5, energy.h5 or a frame");
  sub->add_option("FILE", info.file)->required();
  add_common_options(*sub, common);
  return {sub, &common, [](Progress&) { return show_info(info); }};
}

Command add_diff(CLI::App& app) {
  static DiffCommand diff;
  static CommonOptions common;
  CLI::App* sub = app.add_subcommand(
      "diff", "Compare two patches.h5, energy.h5 or frames; exit code 1 if they differ by more than is allowed");
  sub->add_option("A", diff.a, "The reference")->required();
  sub->add_option("B", diff.b)->required();
  sub->add_option(
         "--tolerance", diff.tolerance,
         "Allowed RMS of differences over the RMS of A's values, NUMBER or GLOB=NUMBER for datasets or layers of "
         "a name; repeatable, the last that fits counts")
      ->allow_extra_args(false);
  sub->add_option("--max", diff.max, "Allowed largest difference over A's largest value, likewise; absent: any")
      ->allow_extra_args(false);
  add_common_options(*sub, common);
  return {sub, &common, [](Progress&) { return compare_files(diff); }};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Patchlight: radiosity from glTF scenes, in stages that run again only when they must.", "patchlight"};
  app.require_subcommand(1);
  app.set_version_flag("--version", patchlight_version());
  const std::vector<Command> commands{add_run(app),     add_status(app),  add_clean(app),
                                      add_preview(app), add_relight(app), add_report(app),
                                      add_bench(app),   add_info(app),    add_diff(app)};
  if (const auto exit_code = parse_options(app, "patchlight", argc, argv)) return *exit_code;
  for (const Command& command : commands) {
    if (!command.app->parsed()) continue;
    int result = 0;
    const int failure = with_progress(command.app->get_name(), *command.options,
                                      [&](Progress& progress) { result = command.act(progress); });
    return failure != 0 ? failure : result;
  }
  return 0;
}
