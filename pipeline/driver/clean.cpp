#include "pipeline/driver/clean.h"

#include <fmt/format.h>

#include "pipeline/driver/bench/bench_run.h"
#include "pipeline/driver/cache/output_cache.h"
#include "pipeline/driver/cache/output_lock.h"
#include "pipeline/driver/slurm/slurm_script.h"
#include "pipeline/driver/stages/job_variants.h"
#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// Bytes that removing a file or folder would free: those of files that stand nowhere else.
std::uintmax_t size_of(const fs::path& path) {
  std::error_code fault;
  const auto alone = [&](const fs::path& file) {
    if (!fs::is_regular_file(fs::symlink_status(file, fault)) || fs::hard_link_count(file, fault) > 1)
      return std::uintmax_t(0);
    return fs::file_size(file, fault);
  };
  if (!fs::is_directory(fs::symlink_status(path, fault))) return alone(path);
  std::uintmax_t size = 0;
  for (fs::recursive_directory_iterator entry(path, fault), end; !fault && entry != end; entry.increment(fault))
    size += alone(entry->path());
  return size;
}

std::uintmax_t discard(const fs::path& path) {
  const std::uintmax_t size = size_of(path);
  std::error_code fault;
  fs::remove_all(path, fault);
  if (fault)
    throw Error(ExitCode::io_error, "cannot remove it: " + fault.message(), path.string(), "check its permissions");
  return size;
}

/// What a job makes in its output folder, by name; what others put there stays.
std::uintmax_t remove_outputs(const Job& job) {
  std::uintmax_t size = 0;
  for (const fs::path& file : {job.patch_file(), job.transport_file(), job.energy_file(), job.output / "report.html"})
    size += discard(file);
  for (const fs::path& file : transport_shard_files(job)) size += discard(file);
  for (const fs::path& file : slurm_files(slurm_folder(job))) size += discard(file);
  std::error_code fault;
  fs::remove(slurm_folder(job), fault);  // if nothing else is in it
  for (const fs::path& folder : {job.frame_folder(), job.relit_folder(), job.output / "preview"}) {
    std::vector<fs::path> pictures;
    for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault))
      if (entry->path().extension() == ".exr" || entry->path().extension() == ".png") pictures.push_back(entry->path());
    for (const fs::path& picture : pictures) size += discard(picture);
    fs::remove(folder, fault);  // if nothing else is in it
  }
  const bool benched = fs::exists(bench_folder(job) / "bench.json", fault);
  return size + (benched ? discard(bench_folder(job)) : 0);
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
        const Job made = read_job(command.job_file, variant.options.sets, variant.options.output);
        size += remove_outputs(made);
        if (made.output != job.output) fs::remove(made.output, fault);
      }
      size += job.matrix.empty() ? 0 : remove_outputs(job);
    }
  }
  fs::remove(job.output, fault);  // if nothing else is in it
  progress.note(fmt::format("removed {:.1f} MiB", double(size) / (1 << 20)));
  return 0;
}

}  // namespace patchlight
