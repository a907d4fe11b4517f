#include "pipeline/driver/slurm/slurm_run.h"

#include <fmt/format.h>

#include "pipeline/driver/slurm/slurm_chain.h"
#include "pipeline/driver/stages/stage_program.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/frames/light_settings.h"
#include "pipeline/job/job_check.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

class SlurmRun {
 public:
  SlurmRun(const RunCommand& command, const Job& job, const OutputCache& cache, StageAccount& account,
           Progress& progress)
      : command_(command), job_(job), cache_(cache), account_(account), progress_(progress) {}

  void run() {
    cancel_leftovers();
    const auto import = [&] { return patches_freshness(job_, scene_); };
    if (account_.needs("import", stage_state(import, [&] { return may_restore() && cache_.restore_patches(job_); })))
      submit({{"import", command("import")}});
    scene_ = read_patches(job_.patch_file());
    cache_.keep_patches(job_, scene_);
    check_names(job_, scene_);
    if (command_.last_stage == "import") return;

    std::vector<SlurmStage> stages;
    const auto solve = [&] { return energy_freshness(job_, scene_); };
    if (account_.needs("solve",
                       stage_state(solve, [&] { return may_restore() && cache_.restore_energy(job_, scene_); })))
      add_solve(stages);
    else
      cache_.keep_energy(job_, scene_);
    if (command_.last_stage == "trace") add_trace(stages);
    submit(stages);
    if (command_.last_stage != "trace") return;
    keep_frames(job_, scene_, cache_);
    cache_.trim();
  }

 private:
  bool may_restore() const { return !command_.force; }

  /// Cancels the jobs of a killed run, which could write into the folder that is checked here. Without Slurm there are
  /// none.
  void cancel_leftovers() const {
    if (slurm_files(slurm_folder(job_)).empty()) return;
    try {
      SlurmClient(job_, cpus()).cancel();
    } catch (const Error& error) {
      if (error.code() != ExitCode::unavailable) throw;
    }
  }

  /// The command line: `arguments`, then the options that pass on the job.
  std::vector<std::string> command(const std::string& stage, std::vector<std::string> arguments = {}) const {
    CommonOptions options = command_.common;
    options.threads = cpus();
    options.quiet = false;
    options.log_json.clear();
    if (!options.output.empty()) options.output = fs::absolute(options.output).string();
    arguments.insert(arguments.begin(), stage_program(stage));
    const std::vector<std::string> job = stage_arguments(fs::absolute(command_.job_file).string(), options);
    arguments.insert(arguments.end(), job.begin(), job.end());
    return arguments;
  }

  int cpus() const { return command_.common.threads > 0 ? command_.common.threads : job_.slurm.cpus; }

  /// The solve, preceded by the missing shards.
  void add_solve(std::vector<SlurmStage>& stages) const {
    const int shards = job_.slurm.shards;
    if (shards == 1 || !is_shardable(job_.solve) || !keeps_transport(job_, scene_) ||
        transport_freshness(job_, scene_).fresh()) {
      stages.push_back({"solve", command("solve")});
      return;
    }
    SlurmStage rows{"rows", command("solve"), shards, {}};
    for (int k = 1; k <= shards; ++k)
      if (!is_fresh_shard(transport_shard_file(job_, {k, shards}), transport_shard_key(job_, scene_, {k, shards})))
        rows.tasks.push_back(k);
    if (!rows.tasks.empty()) stages.push_back(rows);
    stages.push_back({"solve", command("solve", {fmt::format("--merge={}", shards)})});
  }

  void add_trace(std::vector<SlurmStage>& stages) const {
    std::vector<bool> fresh;
    if (!account_.needs("trace", frames_state(job_, scene_, may_restore() ? &cache_ : nullptr, &fresh))) return;
    const int shards = std::min(job_.slurm.shards, int(fresh.size()));
    SlurmStage trace{"trace", command("trace"), shards, {}};
    if (may_restore()) trace.command.insert(trace.command.begin() + 1, "--skip-fresh");
    for (int k = 1; k <= shards; ++k) {
      bool needed = command_.force;
      for (std::size_t i = std::size_t(k) - 1; i < fresh.size(); i += std::size_t(shards)) needed |= !fresh[i];
      if (needed) trace.tasks.push_back(k);
    }
    stages.push_back(trace);
  }

  void submit(const std::vector<SlurmStage>& stages) {
    if (stages.empty()) return;
    const SlurmClient client(job_, cpus());
    std::error_code ignored;
    if (!submitted_)
      for (const fs::path& file : slurm_files(slurm_folder(job_))) fs::remove(file, ignored);  // of earlier runs
    submitted_ = true;
    double rows_wall = 0, rows_cpu = 0;
    const auto done = [&](const SlurmStage& stage, double wall, double cpu) {
      if (stage.name == "rows") {
        rows_wall = wall;
        rows_cpu = cpu;
      } else if (stage.name == "solve") {
        account_.tell({"solve", "done", 0, rows_wall + wall, rows_cpu + cpu});
        cache_.keep_energy(job_, scene_);
      } else {
        account_.tell({stage.name, "done", 0, wall, cpu});
      }
    };
    SlurmChain chain(client, slurm_folder(job_), job_.slurm.retries, progress_);
    try {
      chain.run(stages, done);
    } catch (const Error& error) {
      account_.tell({chain.stage() == "rows" ? "solve" : chain.stage(), "failed", int(error.code())});
      throw;
    }
  }

  const RunCommand& command_;
  const Job& job_;
  const OutputCache& cache_;
  StageAccount& account_;
  Progress& progress_;
  PatchSet scene_;
  bool submitted_ = false;
};

}  // namespace

void run_on_slurm(const RunCommand& command, const Job& job, const OutputCache& cache, StageAccount& account,
                  Progress& progress) {
  SlurmRun(command, job, cache, account, progress).run();
}

}  // namespace patchlight
