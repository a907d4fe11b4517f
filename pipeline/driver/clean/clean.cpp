#include "pipeline/driver/clean/clean.h"

#include <fmt/format.h>

#include "pipeline/driver/bench/bench_run.h"
#include "pipeline/driver/cache/output_cache.h"
#include "pipeline/driver/cache/output_lock.h"
#include "pipeline/driver/clean/own_files.h"
#include "pipeline/driver/slurm/slurm_script.h"
#include "pipeline/driver/stages/job_variants.h"
#include "pipeline/job/blender/blender_export.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// Removes a file. Returns the bytes freed: 0 if it has other hard links.
std::uintmax_t discard(const fs::path& file) {
  std::error_code fault;
  const bool alone = fs::is_regular_file(fs::symlink_status(file, fault)) && fs::hard_link_count(file, fault) == 1;
  const std::uintmax_t size = alone ? fs::file_size(file, fault) : 0;
  fs::remove(file, fault);
  if (fault)
    throw Error(ExitCode::io_error, "cannot remove it: " + fault.message(), file.string(), "check its permissions");
  return size;
}

/// Removes a folder if it is empty.
void remove_if_empty(const fs::path& folder) {
  std::error_code fault;
  if (fs::is_directory(fs::symlink_status(folder, fault))) fs::remove(folder, fault);
}

/// Removes all outputs of stages in a folder.
std::uintmax_t remove_stage_files(const fs::path& output) {
  std::uintmax_t size = 0;
  for (const fs::path& file : own_stage_files(output)) size += discard(file);
  for (const char* folder : {"frames", "relit"}) remove_if_empty(output / folder);
  return size;
}

/// Removes all outputs of `patchlight bench`: the folders of its variants, tables and pictures.
std::uintmax_t remove_bench(const fs::path& bench) {
  std::uintmax_t size = 0;
  std::error_code fault;
  std::vector<fs::path> folders;
  for (fs::directory_iterator entry(bench, fault), end; !fault && entry != end; entry.increment(fault))
    if (fs::is_directory(entry->symlink_status(fault))) folders.push_back(entry->path());
  for (const fs::path& folder : folders) {
    size += OutputCache(folder / "cache", 0).clear() + remove_stage_files(folder);
    remove_if_empty(folder);
  }
  const bool own = is_own_bench(bench / "bench.json");
  for (const char* name :
       {"bench.csv", "bench.json", "comparison.png", "error_against_seconds.gnuplot", "error_against_seconds.png"})
    if (own && fs::is_regular_file(bench / name, fault)) size += discard(bench / name);
  remove_if_empty(bench);
  return size;
}

/// Removes all files that Patchlight wrote into a job's output folder; other files stay.
std::uintmax_t remove_outputs(const Job& job) {
  std::uintmax_t size = remove_stage_files(job.output);
  if (is_own_report(job.output / "report.html")) size += discard(job.output / "report.html");
  for (const fs::path& file : slurm_files(slurm_folder(job))) size += discard(file);
  for (const fs::path& file : own_previews(job.output / "preview")) size += discard(file);
  size += remove_bench(bench_folder(job));
  for (const fs::path& file : files_of_export(job.output)) size += discard(file);
  for (const fs::path& folder : {slurm_folder(job), job.output / "preview", job.output / "blend", cache_folder(job)})
    remove_if_empty(folder);
  return size;
}

}  // namespace

int clean_job(const CleanCommand& command, Progress& progress) {
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  std::error_code fault;
  if (!fs::exists(job.output, fault)) {
    progress.note("nothing to remove");
    return 0;
  }
  std::uintmax_t size = 0;
  {
    OutputLock lock(job, progress);
    lock.for_one();
    size += OutputCache(cache_folder(job), 0).clear();
    if (command.all) {
      for (const JobVariant& variant : job_variants(command.job_file, command.common)) {
        const Job made = variant.job();
        size += remove_outputs(made);
        if (made.output != job.output) remove_if_empty(made.output);
      }
      size += job.matrix.empty() ? 0 : remove_outputs(job);
    }
  }
  remove_if_empty(job.output);
  const std::size_t others = command.all ? count_files(job.output) : 0;
  const std::string left = others > 0 ? fmt::format("; {} other files stay in {}", others, job.output.string()) : "";
  progress.note(fmt::format("removed {:.1f} MiB{}", double(size) / (1 << 20), left));
  return 0;
}

}  // namespace patchlight
