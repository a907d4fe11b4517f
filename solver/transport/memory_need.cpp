#include "solver/transport/memory_need.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "pipeline/model/error.h"
#include "pipeline/optics/lights/direct_light.h"

namespace patchlight {

namespace {

// Measured: largest resident sets of solves with 10,000 to a million patches, 1 to 3 light groups, 16 to 1024 rays.
constexpr double kBase = 40e6;
constexpr double kOfPatch = 600;         // each, as below
constexpr double kOfShardPatch = 150;    // each, without its row
constexpr double kOfGroup = 300;         // of a patch and light group
constexpr double kOfEmitter = 10;        // of a patch and emitter
constexpr double kOfPhotons = 26;        // of a patch and emitter where there are metals
constexpr double kOfProgressive = 350;   // of a patch and light group
constexpr double kOfRay = 4;             // a row's: the patch it ends on
constexpr double kOfDisplay = 250;       // of a patch, and
constexpr double kDisplayRows = 1.2;     // rows of as many rays as a patch has: of vertices, at most
constexpr double kOfHemicubePatch = 16;  // in two hemicubes: patch and form factor

bool has_metals(const PatchSet& scene) {
  return std::any_of(scene.primitives.begin(), scene.primitives.end(),
                     [&](const Primitive& p) { return scene.materials[p.material].specular != Color(0.0f); });
}

double gibibytes(double bytes) {
  return bytes / double(1 << 30);
}

}  // namespace

double memory_needed(const PatchSet& scene, const SolveConfig& config, int rays) {
  const double display = config.display ? kOfDisplay + kDisplayRows * kOfRay * rays : 0.0;
  const auto n = double(scene.patches.size()), groups = double(scene.light_groups.size());
  if (config.method == "progressive") return kBase + n * (kOfPatch + display + kOfProgressive * groups);
  const double cells = 3.0 * config.hemicube_resolution * config.hemicube_resolution;
  const double row = config.form_factors == "rays" ? kOfRay * rays : kOfHemicubePatch * std::min(n, cells);
  const bool photons = config.form_factors == "rays" && has_metals(scene);
  const double emitter = kOfEmitter + (photons ? kOfPhotons : 0.0);
  return kBase + n * (kOfPatch + display + kOfGroup * groups + emitter * double(explicit_emitters(scene).size()) + row);
}

double shard_memory_needed(const PatchSet& scene, const SolveConfig& config, int shards) {
  const double rows = kOfRay * config.rays * (config.display ? 1 + kDisplayRows : 1.0);
  return kBase + double(scene.patches.size()) * (kOfShardPatch + (config.display ? kOfDisplay : 0.0) + rows / shards);
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
              fmt::format("{} patches may need {:.3g} GiB, and {} {:.3g}", scene.patches.size(), gibibytes(needed),
                          config.memory > 0 ? "--memory allows" : "the machine has", gibibytes(allowed)),
              "--memory",
              "raise it, or use a larger import.patch_area or " +
                  std::string(config.form_factors == "rays" ? "fewer solve.rays" : "solve.form_factors: rays"));
}

}  // namespace patchlight
