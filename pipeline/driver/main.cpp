#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "pipeline/driver/commands.h"
#include "pipeline/stage/stage.h"

int main(int argc, char** argv) {
  using namespace patchlight;
  CLI::App app{"Patchlight: radiosity from glTF scenes, in stages that run again only when they must.", "patchlight"};
  app.require_subcommand(1);
  app.set_version_flag("--version", patchlight_version());

  RunCommand run;
  CLI::App* run_app = app.add_subcommand("run", "Run whatever is stale of a job: import, solve, trace");
  run_app->add_option("JOB.yaml", run.job_file, "The job file")->required();
  run_app->add_flag("--force", run.force, "Run every stage, stale or not");
  add_common_options(*run_app, run.common);
  run_app->footer(job_key_help());

  InfoCommand info;
  CLI::App* info_app = app.add_subcommand("info", "Show what is in a glTF scene, patches.h5, energy.h5 or a frame");
  info_app->add_option("FILE", info.file)->required();
  add_common_options(*info_app, run.common);

  DiffCommand diff;
  CLI::App* diff_app = app.add_subcommand(
      "diff", "Compare two patches.h5, energy.h5 or frames; exit code 1 if they differ by more than is allowed");
  diff_app->add_option("A", diff.a, "The reference")->required();
  diff_app->add_option("B", diff.b)->required();
  diff_app
      ->add_option("--tolerance", diff.tolerance,
                   "Allowed RMS of differences over the RMS of A's values; absent: 0, or any with --max")
      ->check(CLI::NonNegativeNumber);
  diff_app->add_option("--max", diff.max, "Allowed largest difference over A's largest value; absent: any")
      ->check(CLI::NonNegativeNumber);

  add_common_options(*diff_app, run.common);

  if (const auto exit_code = parse_options(app, "patchlight", argc, argv)) return *exit_code;
  int result = 0;
  const int failure = with_progress(run_app->parsed()    ? "run"
                                    : info_app->parsed() ? "info"
                                                         : "diff",
                                    run.common, [&](Progress& progress) {
                                      result = run_app->parsed()    ? run_job(run, progress)
                                               : info_app->parsed() ? show_info(info)
                                                                    : compare_files(diff);
                                    });
  return failure != 0 ? failure : result;
}
