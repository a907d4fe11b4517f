#include "solver/transport/memory_need.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "pipeline/model/error.h"
#include "pipeline/optics/lights/direct_light.h"
#include "solver/form_factors/coated_rows.h"

namespace patchlight {

namespace {

// Bytes, measured: peak resident sets of solves with 10,000 to 1,000,000 patches, 1 to 3 light groups, 16 to 1024 rays.
constexpr double kBaseBytes = 40e6;
constexpr double kBytesPerPatch = 650;
constexpr double kBytesPerShardPatch = 150;        // of a patch of a shard's scene, without its row
constexpr double kBytesPerGroup = 300;             // of a patch and light group, for the matrix method
constexpr double kBytesPerEmitter = 10;            // of a patch and emitter
constexpr double kBytesOfPhotons = 26;             // of a patch and emitter in scenes with metals
constexpr double kBytesPerProgressiveGroup = 350;  // of a patch and light group, for progressive refinement
constexpr double kBytesPerRay = 4;                 // of a row's ray: its column
constexpr double kBytesOfCoats = 3;                // the same, on average, for what rays meet after coats
constexpr double kBytesPerLightRay = 8;            // to one of many emitters: its patch and weight
constexpr double kGuidedRays = 2;                  // rays of a patch's row with a guide over those of others
constexpr double kGuidedPointRays = 5;             // the same of a vertex, those of large faces among them
constexpr double kBytesOfDisplay = 250;            // of a patch, for the display solution
constexpr double kDisplayRayRatio = 2.0;  // upper bound of the rays of the display mesh over the rays of the patches
constexpr double kBytesPerHemicubePatch = 16;  // of a patch visible in a row's two hemicubes: column and weight

/// Of a ray: its column, and what it hits after a coat.
double ray_bytes(const PatchSet& scene) {
  return kBytesPerRay + (has_coats(scene.materials) ? kBytesOfCoats : 0.0);
}

/// Upper bound of the bytes of a row by `rays` rays.
double row_bytes(const PatchSet& scene, int rays) {
  return ray_bytes(scene) * rays * (scene.environment ? kGuidedRays : 1.0);
}

/// The same of a patch's rows of the display solution.
double display_row_bytes(const PatchSet& scene, int rays) {
  return kDisplayRayRatio * ray_bytes(scene) * rays * (scene.environment ? kGuidedPointRays : 1.0);
}

double gibibytes(double bytes) {
  return bytes / double(1 << 30);
}

}  // namespace

double memory_needed(const PatchSet& scene, const SolveConfig& config, int rays) {
  const double display = config.display ? kBytesOfDisplay + display_row_bytes(scene, rays) : 0.0;
  const auto n = double(scene.patches.size()), groups = double(scene.light_groups.size());
  if (config.method == "progressive")
    return kBaseBytes + n * (kBytesPerPatch + display + kBytesPerProgressiveGroup * groups);
  const double cells = 3.0 * config.hemicube_resolution * config.hemicube_resolution;
  const double row =
      config.form_factors == "rays" ? row_bytes(scene, rays) : kBytesPerHemicubePatch * std::min(n, cells);
  const bool photons = config.form_factors == "rays" && has_metals(scene);
  const double emitter = kBytesPerEmitter + (photons ? kBytesOfPhotons : 0.0);
  const double light_rays =
      further_emitters(scene).empty() ? 0.0 : 0.5 * rays * (config.display ? 1 + kDisplayRayRatio : 1.0);
  return kBaseBytes + n * (kBytesPerPatch + display + kBytesPerGroup * groups +
                           emitter * double(explicit_emitters(scene).size()) + row + kBytesPerLightRay * light_rays);
}

double shard_memory_needed(const PatchSet& scene, const SolveConfig& config, int shards) {
  const double rows = row_bytes(scene, config.rays) + (config.display ? display_row_bytes(scene, config.rays) : 0.0);
  return kBaseBytes + double(scene.patches.size()) *
                          (kBytesPerShardPatch + (config.display ? kBytesOfDisplay : 0.0) + rows / shards);
}

double memory_allowed(const SolveConfig& config) {
  if (config.memory > 0) return double(config.memory);
  return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
}

void check_memory(const PatchSet& scene, const SolveConfig& config, int shards) {
  const double needed =
      shards > 0 ? shard_memory_needed(scene, config, shards) : memory_needed(scene, config, config.rays);
  const double allowed = memory_allowed(config);
  if (needed <= allowed) return;
  throw Error(ExitCode::over_limit,
              fmt::format("{} patches may need {:.3g} GiB, but {} {:.3g} GiB", scene.patches.size(), gibibytes(needed),
                          config.memory > 0 ? "--memory allows" : "the machine has", gibibytes(allowed)),
              "--memory",
              "raise it, or use a larger import.patch_area or " +
                  std::string(config.form_factors == "rays" ? "fewer solve.rays" : "solve.form_factors: rays"));
}

}  // namespace patchlight
