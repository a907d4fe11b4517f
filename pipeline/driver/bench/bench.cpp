#include "pipeline/driver/bench/bench.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/driver/bench/bench_report.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

std::string summary(const Measurement& m) {
  if (m.exit_code != 0) return fmt::format("{} (exit code {})", m.fault, m.exit_code);
  std::string text =
      fmt::format("{:.3g} CPU s (import {:.2g}, solve {:.2g}, trace {:.2g}), {} MiB, block error {:.3g}%",
                  m.cpu_seconds(), m.stages[0].cpu_seconds, m.stages[1].cpu_seconds, m.stages[2].cpu_seconds,
                  m.peak_bytes() >> 20, 100 * m.error.block);
  if (m.radiosity_error) text += fmt::format(", radiosity error {:.3g}%", 100 * *m.radiosity_error);
  return text;
}

/// If the reference has coarser patches than the sweep, a finer variant would count as wrong.
void warn_of_coarse_reference(const Job& job, Progress& progress) {
  const BenchConfig& bench = job.bench;
  if (bench.radiance || !bench.reference.empty() || bench.reference_settings.contains("import.patch_area")) return;
  for (const SweepGrid& grid : bench.sweep)
    for (const SweepAxis& axis : grid)
      if (axis.key == "import.patch_area")
        progress.warning(
            "the sweep changes import.patch_area but the reference has the job's own: give "
            "bench.reference_settings a finer one");
}

/// Refuses a sweep whose frames cannot be averaged down to the size of the reference, or the reference to theirs.
void check_sizes(const Job& job, const CommonOptions& common, const std::vector<Variant>& variants,
                 const Image& reference) {
  for (const Variant& variant : variants) {
    std::vector<std::string> sets = common.sets;
    for (const auto& [key, value] : variant.settings) sets.push_back(key + "=" + value);
    const auto size = read_job(job.file, sets).trace.resolution;
    if (!size) continue;  // of the camera's shape
    const auto [width, height] = *size;
    const int rows = std::min(height, reference.height), a = height / rows, b = reference.height / rows;
    const bool fits = a * rows == height && b * rows == reference.height && width % a == 0 &&
                      reference.width % b == 0 && width / a == reference.width / b;
    if (!fits)
      throw Error(ExitCode::bad_config,
                  fmt::format("frames of {} x {} cannot be compared with a reference of {} x {}", width, height,
                              reference.width, reference.height),
                  job.file.string() + ", trace.resolution", "make one's sides the same whole multiple of the other's");
  }
}

}  // namespace

int bench_job(const BenchCommand& command, Progress& progress) {
  Progress::catch_signals();
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  if (job.bench.sweep.empty())
    throw Error(ExitCode::bad_config, "nothing to sweep", job.file.string() + ", bench.sweep",
                "add for example `bench: {sweep: [{solve.rays: [64, 256, 1024]}]}`");
  check_gnuplot();
  warn_of_coarse_reference(job, progress);
  const Reference reference = bench_reference(job, command.common, progress);
  const std::vector<Variant> variants = bench_variants(job.bench.sweep);
  if (reference.frame) check_sizes(job, command.common, variants, *reference.frame);
  VariantRunner runner(job, command.common, reference);
  std::vector<Measurement> measurements;
  int first_failure = 0;
  for (const Variant& variant : variants) {
    Progress::check_interrupted();
    measurements.push_back(runner.run(variant));
    const Measurement& m = measurements.back();
    const std::string line =
        fmt::format("{}/{} {}: {}", measurements.size(), variants.size(), variant.label, summary(m));
    if (m.exit_code != 0)
      progress.warning(line);
    else
      progress.note(line);
    if (first_failure == 0) first_failure = m.exit_code;
    write_report(job, command.common, reference, measurements);
  }
  draw_comparison(job, reference, measurements);
  plot_errors(job, measurements);
  progress.note("results are in " + bench_folder(job).string());
  return first_failure;
}

}  // namespace patchlight
