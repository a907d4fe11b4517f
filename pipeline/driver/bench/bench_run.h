#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pipeline/driver/bench/bench_variants.h"
#include "pipeline/driver/stages/stage_program.h"
#include "pipeline/image/image_error.h"
#include "pipeline/stage/stage.h"

namespace patchlight {

constexpr std::array<const char*, 3> kStages{"import", "solve", "trace"};

/// Cost and error of one variant.
struct Measurement {
  Variant variant;
  int exit_code = 0;                   ///< Of the failed stage; 0: all members below are valid.
  std::string fault;                   ///< Message; empty if all stages succeeded.
  std::array<ProgramRun, 3> stages{};  ///< In the order of kStages; each is the run of median CPU seconds.
  std::int64_t patches = 0;
  std::int64_t rays = 0;
  std::int64_t iterations = 0;
  double residual = 0;
  std::filesystem::path frame;  ///< EXR.
  ImageError error;
  std::optional<double> radiosity_error;  ///< Present if the reference was solved on the same patches.

  double cpu_seconds() const;
  double wall_seconds() const;
  std::int64_t peak_bytes() const;  ///< Maximum over the stages.
};

/// The folder of all bench output.
std::filesystem::path bench_folder(const Job& job);

/// The reference that frames are compared with.
struct Reference {
  std::string origin;                             ///< Description, for messages and bench.json.
  std::optional<Image> frame;                     ///< Absent: the reference is a closed form.
  Color radiance{0.0f};                           ///< The closed form: constant radiance, W/m2/sr.
  std::filesystem::path patch_file, energy_file;  ///< Empty unless the reference was solved by a run of this job.

  /// The reference frame; for a closed form, a constant image of the size of `image`.
  Image like(const Image& image) const;
};

/// Reads the job's reference, or renders it by a separate run, which is skipped if it is fresh.
/// Throws: Error (missing_input, bad_data); the exit code of the failed stage if that run fails.
Reference bench_reference(const Job& job, const CommonOptions& common, Progress& progress);

/// Runs variants one after another. If a stage and the stages before it have the settings of an earlier variant, the
/// earlier output is hard-linked and the earlier measurement is reused.
class VariantRunner {
 public:
  VariantRunner(const Job& job, const CommonOptions& common, const Reference& reference)
      : job_(job), common_(common), reference_(reference) {}

  /// Throws: Error (interrupted). A failed stage is reported in the Measurement.
  Measurement run(const Variant& variant);

 private:
  struct StageOutput {
    std::filesystem::path folder;
    ProgramRun run;
  };

  void run_stages(Measurement& result, const std::filesystem::path& folder);
  void evaluate(Measurement& result, const std::vector<std::string>& sets, const std::filesystem::path& folder) const;

  const Job& job_;
  const CommonOptions& common_;
  const Reference& reference_;
  std::map<std::string, StageOutput> outputs_;  ///< By stage and settings.
};

}  // namespace patchlight
