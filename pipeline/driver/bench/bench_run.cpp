#include "pipeline/driver/bench/bench_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/driver/commands/run.h"
#include "pipeline/driver/stages/run_command.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/frames/frame_list.h"
#include "pipeline/job/frame_range.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// Index into kStages of the first stage that reads a key.
std::size_t stage_of(const std::string& key) {
  const std::string section = key.substr(0, key.find('.'));
  if (section == "scene" || section == "import" || section == "materials") return 0;
  return section == "solve" ? 1 : 2;
}

/// Restricts a job, whose patches.h5 is in `folder`, to the compared frame: the first frame of one camera.
void restrict_to_frame(const Job& job, const std::string& job_file, std::vector<std::string>& sets,
                       const fs::path& folder) {
  std::string camera = job.bench.camera;
  const Job variant = read_job(job_file, sets, folder);
  if (camera.empty() && !variant.trace.cameras.empty()) camera = variant.trace.cameras.front();
  if (camera.empty()) camera = read_patches(variant.patch_file()).cameras.at(0).name;
  sets.push_back("trace.cameras=" + nlohmann::json::array({camera}).dump());
  sets.push_back(fmt::format("trace.frames={}", frame_numbers(variant.trace.frames).front()));
}

/// Runs a stage `repeats` times from the same inputs. Returns the run of median CPU seconds, or the first failed run.
ProgramRun measure(const std::string& stage, const Job& job, const CommonOptions& options) {
  std::vector<ProgramRun> runs;
  for (int i = 0; i < job.bench.repeats; ++i) {
    Progress::check_interrupted();
    if (stage == "solve")  // the solver would reuse the output of an earlier repeat
      for (const char* file : {"energy.h5", "transport.h5"}) fs::remove(fs::path(options.output) / file);
    runs.push_back(run_stage_program(stage, stage_arguments(job.file.string(), options)));
    if (runs.back().exit_code != 0) return runs.back();
  }
  const auto middle = runs.begin() + std::ptrdiff_t(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end(),
                   [](const ProgramRun& a, const ProgramRun& b) { return a.cpu_seconds < b.cpu_seconds; });
  return *middle;
}

void link_file(const fs::path& from, const fs::path& to) {
  std::error_code fault;
  fs::create_directories(to.parent_path());
  fs::create_hard_link(from, to, fault);
  if (fault) fs::copy_file(from, to);
}

void stop_if_interrupted(int exit_code) {
  if (exit_code == int(ExitCode::interrupted))
    throw Error(ExitCode::interrupted, "interrupted", "", "finished measurements are in the bench folder");
}

}  // namespace

double Measurement::cpu_seconds() const {
  return stages[0].cpu_seconds + stages[1].cpu_seconds + stages[2].cpu_seconds;
}

double Measurement::wall_seconds() const {
  return stages[0].wall_seconds + stages[1].wall_seconds + stages[2].wall_seconds;
}

std::int64_t Measurement::peak_bytes() const {
  return std::max({stages[0].peak_bytes, stages[1].peak_bytes, stages[2].peak_bytes});
}

fs::path bench_folder(const Job& job) {
  return job.output / "bench";
}

Image Reference::like(const Image& image) const {
  if (frame) return *frame;
  return {image.width, image.height, std::vector<Color>(image.pixels.size(), radiance), {}};
}

Reference bench_reference(const Job& job, const CommonOptions& common, Progress& progress) {
  const BenchConfig& bench = job.bench;
  if (bench.radiance)
    return {fmt::format("radiance {} {} {}", bench.radiance->x, bench.radiance->y, bench.radiance->z),
            {},
            *bench.radiance,
            {},
            {}};
  if (!bench.reference.empty()) return {bench.reference.string(), read_exr(bench.reference), Color(0.0f), {}, {}};

  RunCommand run{job.file.string(), false, common};
  run.common.output = (bench_folder(job) / "reference").string();
  std::string origin;
  for (const auto& [key, value] : bench.reference_settings) {
    run.common.sets.push_back(key + "=" + value);
    origin += (origin.empty() ? "a run with " : ", ") + key + " " + value;
  }
  progress.note("reference: " + origin);
  const auto check = [](int exit_code) {
    stop_if_interrupted(exit_code);
    if (exit_code != 0)
      throw Error(ExitCode(exit_code), "the reference run failed", "bench.reference_settings", "see the message above");
  };
  // The camera name may come from the scene; run_job() finds this import fresh.
  check(run_stage_program("import", stage_arguments(run.job_file, run.common)).exit_code);
  restrict_to_frame(job, run.job_file, run.common.sets, run.common.output);
  check(run_job(run, progress));
  const Job made = read_job(run.job_file, run.common.sets, run.common.output);
  const Frame frame = job_frames(made, read_patches(made.patch_file())).at(0);
  return {origin, read_exr(frame.exr), Color(0.0f), made.patch_file(), made.energy_file()};
}

Measurement VariantRunner::run(const Variant& variant) {
  Measurement result;
  result.variant = variant;
  const fs::path folder = bench_folder(job_) / variant.name;
  try {
    fs::remove_all(folder);
    run_stages(result, folder);
  } catch (const Error& error) {
    stop_if_interrupted(int(error.code()));
    result.exit_code = int(error.code());
    result.fault = error.what();
  } catch (const fs::filesystem_error& error) {
    result.exit_code = int(ExitCode::io_error);
    result.fault = error.what();
  }
  return result;
}

void VariantRunner::run_stages(Measurement& result, const fs::path& folder) {
  CommonOptions options = common_;
  options.output = folder.string();
  options.threads = std::max(1, common_.threads);
  options.quiet = true;
  for (const auto& [key, value] : result.variant.settings) options.sets.push_back(key + "=" + value);
  for (std::size_t k = 0; k < kStages.size(); ++k) {
    std::string inputs = kStages[k];
    for (const auto& [key, value] : result.variant.settings)
      if (stage_of(key) <= k) inputs += "\n" + key + "=" + value;
    if (const auto found = outputs_.find(inputs); k < 2 && found != outputs_.end()) {
      const char* output = k == 0 ? "patches.h5" : "energy.h5";
      link_file(found->second.folder / output, folder / output);
      result.stages[k] = found->second.run;
      continue;
    }
    if (k == 2) restrict_to_frame(job_, job_.file.string(), options.sets, folder);
    result.stages[k] = measure(kStages[k], job_, options);
    result.exit_code = result.stages[k].exit_code;
    stop_if_interrupted(result.exit_code);
    if (result.exit_code != 0) {
      result.fault = fmt::format("{} failed", kStages[k]);
      return;
    }
    outputs_[inputs] = {folder, result.stages[k]};
  }
  evaluate(result, options.sets, folder);
}

void VariantRunner::evaluate(Measurement& result, const std::vector<std::string>& sets, const fs::path& folder) const {
  const Job job = read_job(job_.file, sets, folder);
  const PatchSet scene = read_patches(job.patch_file());
  const EnergyField energy = read_energy(job.energy_file(), scene);
  result.patches = std::int64_t(scene.patches.size());
  result.rays = energy.rays;
  result.iterations = energy.iterations;
  result.residual = energy.residual;
  result.frame = job_frames(job, scene).at(0).exr;
  const Image image = read_exr(result.frame);
  result.error = image_error(image, reference_.like(image));
  if (reference_.energy_file.empty()) return;
  const EnergyField truth = read_energy(reference_.energy_file);
  if (truth.patches_key == scene.key) result.radiosity_error = radiosity_error(scene, energy, truth);
}

}  // namespace patchlight
