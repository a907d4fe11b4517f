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

/// What one variant took and gave.
struct Measurement {
  Variant variant;
  int exit_code = 0;                   ///< Of the stage that failed; 0: all below is valid.
  std::string fault;                   ///< For people; empty if all went well.
  std::array<ProgramRun, 3> stages{};  ///< In the order of kStages; each the one of median CPU seconds.
  std::int64_t patches = 0;
  std::int64_t rays = 0;
  std::int64_t iterations = 0;
  double residual = 0;
  std::filesystem::path frame;  ///< EXR.
  ImageError error;
  std::optional<double> radiosity_error;  ///< Where the reference was solved on the same patches.

  double cpu_seconds() const;
  double wall_seconds() const;
  std::int64_t peak_bytes() const;  ///< Of the largest stage.
};

/// Where all of the bench's output stands.
std::filesystem::path bench_folder(const Job& job);

/// A reference that frames are compared with.
struct Reference {
  std::string origin;                             ///< For people and for bench.json.
  std::optional<Image> frame;                     ///< Absent: a closed form.
  Color radiance{0.0f};                           ///< The closed form, W/m2/sr.
  std::filesystem::path patch_file, energy_file;  ///< Empty unless it was solved here.

  /// The reference's own pixels; those of a closed form are as many as the image's.
  Image like(const Image& image) const;
};

/// Reads the job's reference, or makes it by a run of its own, which is skipped while it is up to date.
/// Throws: Error (missing_input, bad_data); any stage's exit code if that run fails.
Reference bench_reference(const Job& job, const CommonOptions& common, Progress& progress);

/// Runs variants one after another. A stage whose settings, and those of the stages before it, are an earlier
/// variant's is not run again: its output is linked and its measurement stands for both.
class VariantRunner {
 public:
  VariantRunner(const Job& job, const CommonOptions& common, const Reference& reference)
      : job_(job), common_(common), reference_(reference) {}

  /// Throws: Error (interrupted); a variant's own failure stands in its Measurement.
  Measurement run(const Variant& variant);

 private:
  struct Made {
    std::filesystem::path folder;
    ProgramRun run;
  };

  void run_stages(Measurement& result, const std::filesystem::path& folder);
  void evaluate(Measurement& result, const std::vector<std::string>& sets, const std::filesystem::path& folder) const;

  const Job& job_;
  const CommonOptions& common_;
  const Reference& reference_;
  std::map<std::string, Made> made_;  ///< By stage and settings.
};

}  // namespace patchlight
