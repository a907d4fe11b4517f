#include "pipeline/driver/bench/bench.h"
#include "pipeline/driver/clean/clean.h"
#include "pipeline/driver/commands/batch.h"
#include "pipeline/driver/commands/diff.h"
#include "pipeline/driver/commands/from_blend.h"
#include "pipeline/driver/commands/info.h"
#include "pipeline/driver/commands/init.h"
#include "pipeline/driver/commands/preview.h"
#include "pipeline/driver/commands/relight.h"
#include "pipeline/driver/commands/status.h"
#include "pipeline/driver/report/report.h"
#include "pipeline/job/reader/job_reader.h"

namespace {

using namespace patchlight;

/// A subcommand with the function that it calls.
struct Action {
  Command command;
  const CommonOptions* options;
  std::function<int(Progress&)> act;
};

Action make_action(Command command, CommonOptions& common, std::function<int(Progress&)> act) {
  for (Option& option : common_options(common)) command.options.push_back(std::move(option));
  return {std::move(command), &common, std::move(act)};
}

Option variant_option(std::string& pattern) {
  return {
      .name = "--variant", .value = &pattern, .help = "Only variants of the job's matrix whose name matches this glob"};
}

Option file_argument(const char* name, std::string& file, const char* help) {
  return {.name = name, .value = &file, .help = help, .required = true, .completion = Option::Completion::file};
}

Action make_run() {
  static BatchCommand run;
  return make_action({.name = "run",
                      .purpose = "Run the stale stages of jobs and their variants: import, solve, trace",
                      .options = {job_argument(run.job_files),
                                  variant_option(run.variant),
                                  {.name = "--force", .value = &run.force, .help = "Run every stage, stale or not"},
                                  {.name = "--explain",
                                   .value = &run.explain,
                                   .help = "Print all reasons why each stage runs or is skipped"}},
                      .footer = job_key_help},
                     run.common, [](Progress& progress) { return run_jobs(run, progress); });
}

Action make_init() {
  static InitCommand init;
  return make_action(
      {.name = "init",
       .purpose = "Print a commented job for a scene, with its cameras, light groups and materials: init "
                  "A.glb > A.yaml",
       .options = {file_argument("SCENE", init.scene, "The scene, .glb, .gltf or .blend")}},
      init.common, [](Progress& progress) { return print_starter_job(init, progress); });
}

Action make_status() {
  static StatusCommand status;
  return make_action(
      {.name = "status",
       .purpose = "List a job's stages and frames: fresh, stale, missing, damaged; exit code 1 unless all are fresh",
       .options = {job_argument(status.job_files), variant_option(status.variant)},
       .footer = job_key_help},
      status.common, [](Progress&) { return show_status(status); });
}

Action make_clean() {
  static CleanCommand clean;
  return make_action(
      {.name = "clean",
       .purpose = "Remove the outputs of earlier settings that a job keeps",
       .options = {job_argument(clean.job_file),
                   {.name = "--all", .value = &clean.all, .help = "Also remove all other files that Patchlight wrote"}},
       .footer = job_key_help},
      clean.common, [](Progress& progress) { return clean_job(clean, progress); });
}

Action make_preview() {
  static PreviewCommand preview;
  return make_action(
      {.name = "preview",
       .purpose = "Draw a job's patches, radiosity, irradiance or hemicubes",
       .options = {job_argument(preview.job_file),
                   {.name = "--kind",
                    .value = &preview.kind,
                    .help = "What to draw",
                    .shows_default = true,
                    .choices = {"patches", "radiosity", "irradiance", "hemicube"}},
                   {.name = "--camera", .value = &preview.camera, .help = "The camera; absent: the job's first"},
                   {.name = "--patch",
                    .value = &preview.patch,
                    .help = "The patch to highlight, or to draw the hemicube of",
                    .not_negative = true}}},
      preview.common, [](Progress& progress) { return draw_preview(preview, progress); });
}

Action make_relight() {
  static RelightCommand relight;
  return make_action(
      {.name = "relight",
       .purpose =
           "Make frames under other `lights`, without a trace, from the layers `light_groups` of existing frames",
       .options = {job_argument(relight.job_file),
                   variant_option(relight.variant),
                   {.name = "--force", .value = &relight.force, .help = "Make every frame, stale or not"},
                   {.name = "--explain", .value = &relight.explain, .help = "Print all reasons why frames are made"}},
       .footer = job_key_help},
      relight.common, [](Progress& progress) { return relight_jobs(relight, progress); });
}

Action make_report() {
  static ReportCommand report;
  return make_action({.name = "report",
                      .purpose = "Write one HTML page of a job's frames, counts, times, convergence, errors, "
                                 "irradiance and warnings",
                      .options = {job_argument(report.job_file), variant_option(report.variant)},
                      .footer = job_key_help},
                     report.common, [](Progress& progress) { return write_report_page(report, progress); });
}

Action make_bench() {
  static BenchCommand bench;
  return make_action({.name = "bench",
                      .purpose = "Measure time, memory and error of a job over its `bench.sweep`; write tables, a plot "
                                 "and pictures",
                      .options = {job_argument(bench.job_file)},
                      .footer = job_key_help},
                     bench.common, [](Progress& progress) { return bench_job(bench, progress); });
}

Action make_from_blend() {
  static FromBlendCommand from_blend;
  static CommonOptions common;
  return make_action(
      {.name = "from-blend",
       .purpose = "Write the glTF scene and the job of a Blender file beside it, as Cycles would render it",
       .options = {file_argument("FILE", from_blend.blend, "The Blender file"),
                   {.name = "--force", .value = &from_blend.force, .help = "Replace a job that is there already"}}},
      common, [](Progress& progress) { return export_from_blend(from_blend, progress); });
}

Action make_info() {
  static InfoCommand info;
  static CommonOptions common;
  return make_action({.name = "info",
                      .purpose = "Show what is in a scene, patches.h5, energy.h5 or a frame",
                      .options = {file_argument("FILE", info.file, "")}},
                     common, [](Progress&) { return show_info(info); });
}

Action make_diff() {
  static DiffCommand diff;
  static CommonOptions common;
  return make_action(
      {.name = "diff",
       .purpose = "Compare two patches.h5, energy.h5 or frames; exit code 1 if they differ by more than is allowed",
       .options = {file_argument("A", diff.a, "The reference"),
                   file_argument("B", diff.b, ""),
                   {.name = "--tolerance",
                    .value = &diff.tolerance,
                    .help = "Allowed RMS of differences over the RMS of A's values, NUMBER or GLOB=NUMBER for datasets "
                            "or layers of a name; repeatable, the last that fits counts"},
                   {.name = "--max",
                    .value = &diff.max,
                    .help = "Allowed largest difference over A's largest value, likewise; absent: any"}}},
      common, [](Progress&) { return compare_files(diff); });
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Action> actions{make_run(),        make_init(),    make_status(), make_clean(),
                                    make_preview(),    make_relight(), make_report(), make_bench(),
                                    make_from_blend(), make_info(),    make_diff()};
  Command program{.name = "patchlight",
                  .purpose = "Patchlight: radiosity from glTF scenes, in stages that run again only when they must."};
  for (const Action& action : actions) program.subcommands.push_back(action.command);
  const ParsedCommand parsed = parse_command_line(program, argc, argv);
  if (parsed.exit_code) return *parsed.exit_code;
  for (const Action& action : actions) {
    if (action.command.name != parsed.subcommand) continue;
    int result = 0;
    const int failure =
        with_progress(parsed.subcommand, *action.options, [&](Progress& progress) { result = action.act(progress); });
    return failure != 0 ? failure : result;
  }
  return 0;
}
